"""The parts of a codec."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from ur_nodes.codecs.dialect import Headed, ServiceFailureError, ServiceMessages, time_of
from ur_nodes.ports.values import Result

Message = TypeVar("Message")
Request = TypeVar("Request")
Response = TypeVar("Response")
Value = TypeVar("Value")

LARGE = 1 << 24
"""Bytes that are read at once of messages such as pictures: in small pieces they take several times as long."""


@dataclass(frozen=True, slots=True)
class Codec(Generic[Message, Value]):
    """The messages of a kind of value: `fill` writes a value, `value_of` reads it, and raises ValueError or UserError.

    A message may be filled again for the next value. `buffer` is the number of bytes that are read at once.
    """

    message_class: type[Message]
    fill: Callable[[Message, Value], None]
    value_of: Callable[[Message], Value]
    buffer: int = 1 << 16


@dataclass(frozen=True, slots=True)
class ServiceCodec(Generic[Request, Response, Value]):
    """The messages of a kind of request and of its answer.

    `response` raises ServiceFailureError where a failure cannot be reported otherwise.
    """

    service_class: ServiceMessages[Request, Response]
    request: Callable[[Value], Request]
    request_of: Callable[[Request], Value]
    response: Callable[[Result], Response]
    result_of: Callable[[Response], Result]


KindCodec = Codec[Any, Value]
"""The codec of a kind of value; only the codec knows the class of the messages."""

KindServiceCodec = ServiceCodec[Any, Any, Value]


def value_or_fail(result: Result) -> Any:
    """Return the value of a service's result. Raises ServiceFailureError: the answer has no field for the failure."""
    if not result.success:
        raise ServiceFailureError(result.text)
    return result.value


def response_or_fail(result: Result, response: Response) -> Response:
    """Return a response that has no field for a failure. Raises ServiceFailureError."""
    value_or_fail(result)
    return response


def fill_header(message: Headed, stamp: int, frame: str) -> None:
    """Write a message's header."""
    message.header.stamp = time_of(stamp)
    message.header.frame_id = frame


def frame_of(message: Headed) -> str:
    """Return the frame of a message, without the leading slash of early tf."""
    return str(message.header.frame_id).lstrip("/")
