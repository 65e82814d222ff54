"""Messages of packages that may not be installed, by the names of their types."""

from importlib import import_module
from typing import Any

from ur_nodes.codecs.codec import Codec, KindCodec
from ur_nodes.codecs.dialect import ROS_2


def find_foreign(type_name: str, fields: tuple[str, ...]) -> KindCodec[tuple[Any, ...]]:
    """Make a codec that reads fields of a type. Raises LookupError: not installed; ValueError: a field is missing."""
    found = _find_ros_2(type_name) if ROS_2 else _find_ros_1(type_name)
    if found is None:
        raise LookupError(type_name)
    known = found.get_fields_and_field_types() if ROS_2 else getattr(found, "__slots__", ())
    if not set(fields) <= set(known):
        raise ValueError(f"{type_name} has no {', '.join(fields)}")
    return Codec(found, _refuse, lambda message: tuple(getattr(message, each) for each in fields))


def _find_ros_1(type_name: str) -> Any:
    from roslib.message import get_message_class

    try:
        return get_message_class(type_name)
    except (ImportError, ValueError):
        return None


def _find_ros_2(type_name: str) -> Any:
    package, _, name = type_name.rpartition("/")
    try:
        return getattr(import_module(f"{package.removesuffix('/msg')}.msg"), name, None)
    except ImportError:
        return None


def _refuse(_message: object, _value: object) -> None:
    raise TypeError("messages of this type are only received")
