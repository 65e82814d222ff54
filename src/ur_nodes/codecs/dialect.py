"""Differences between the messages of ROS 1 and ROS 2. Packages have the same names: a process knows one of both."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import Header

if TYPE_CHECKING:
    from genpy import Duration as Span
    from genpy import Time as Stamp

Number = TypeVar("Number", bound=np.generic)
Request = TypeVar("Request")
Response = TypeVar("Response")

_Time = type(Header().stamp)
ROS_2: bool = hasattr(_Time(), "nanosec")
"""The messages that are installed are those of ROS 2."""
_SECOND = 1_000_000_000

if ROS_2 and not TYPE_CHECKING:  # types are those of ROS 1, whose stubs have the fields of both
    from builtin_interfaces.msg import Duration as DurationMessage
    from builtin_interfaces.msg import Time as TimeMessage
    from rcl_interfaces.msg import Log as LogMessage
    from sensor_msgs.msg import LaserScan as ScanMessage

    from ur_nodes.codecs import bare

    try:
        from tf2_msgs.msg import TFMessage as Transforms
    except ImportError:
        Transforms = bare.BareTransforms
else:
    from genpy import Duration as DurationMessage
    from rosgraph_msgs.msg import Log as LogMessage
    from std_msgs.msg import Time as TimeMessage
    from tf2_msgs.msg import TFMessage as Transforms

    from ur_nodes.codecs.genpy.scan import ScanMessage

__all__ = ["ROS_2", "Headed", "LogMessage", "ScanMessage", "ServiceMessages", "TimeMessage", "Transforms"]


class ServiceMessages(Protocol[Request, Response]):
    """A class of services, as genpy makes it."""

    _request_class: type[Request]
    _response_class: type[Response]


class Headed(Protocol):
    """A message with a header."""

    header: Header


@lru_cache(maxsize=4)
def time_of(stamp: int) -> Stamp:
    """Convert a stamp (ns) to a message's time; messages of one moment share it."""
    seconds, rest = divmod(stamp, _SECOND)
    return _Time(sec=seconds, nanosec=rest) if ROS_2 else _Time(seconds, rest)


def duration_of(seconds: float) -> Span:
    """Convert a duration to a message's."""
    whole, rest = divmod(round(seconds * _SECOND), _SECOND)
    return DurationMessage(sec=whole, nanosec=rest) if ROS_2 else DurationMessage(whole, rest)


def stamp_of(time: Stamp | Span) -> int:
    """Convert a message's time to a stamp (ns)."""
    return int(time.sec) * _SECOND + int(time.nanosec) if ROS_2 else int(time.secs) * _SECOND + int(time.nsecs)


def seconds_of(span: Span) -> float:
    """Convert a message's duration to s."""
    return stamp_of(span) / 1e9


def number_of(message: Headed) -> int:
    """Return the sequence number of a message; 0 on ROS 2, whose headers have none."""
    return 0 if ROS_2 else int(message.header.seq)


def bytes_of(field: bytes) -> bytes:
    """Return the bytes of a field."""
    return bytes(field)


def field_of(values: NDArray[Number]) -> Sequence[Any]:
    """Convert an array (n) of float32, int8 or uint8 to a message's field, without a copy where possible."""
    if not ROS_2:
        return cast("Sequence[Any]", values)
    code = {"float32": "f", "int8": "b", "uint8": "B"}[values.dtype.name]
    return array(code, np.ascontiguousarray(values).tobytes())


def array_of(field: Sequence[float], dtype: type[Number]) -> NDArray[Number]:
    """Return a message's field as array (n), which shares its memory where possible."""
    if isinstance(field, bytes | bytearray | array):
        return np.frombuffer(field, dtype)
    return np.asarray(field, dtype=dtype)


def parts_of(service: ServiceMessages[Request, Response]) -> tuple[type[Request], type[Response]]:
    """Return the classes of a service's request and response."""
    if ROS_2:
        return service.Request, service.Response  # type: ignore[attr-defined]  # of ROS 2's classes
    return service._request_class, service._response_class  # noqa: SLF001 - where genpy keeps them


class ServiceFailureError(Exception):
    """A failure for which the response of a service has no field."""
