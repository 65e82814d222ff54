"""Messages of packages that may not be installed, by the names of their types."""

from __future__ import annotations

from typing import Any

from roslib.message import get_message_class

from ur_nodes.ros1.codecs.codec import Codec


def find_foreign(type_name: str, fields: tuple[str, ...]) -> Codec:
    """A codec that reads fields of a type. Raises LookupError: it is not installed; ValueError: it lacks one."""
    found: Any
    try:
        found = get_message_class(type_name)
    except (ImportError, ValueError):
        found = None
    if found is None:
        raise LookupError(type_name)
    if not set(fields) <= set(getattr(found, "__slots__", ())):
        raise ValueError(f"{type_name} has no {', '.join(fields)}")
    return Codec(found, _refuse, lambda message: tuple(getattr(message, each) for each in fields))


def _refuse(_message: Any, _value: Any) -> None:
    raise TypeError("messages of this type are only received")
