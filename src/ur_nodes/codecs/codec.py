"""The parts of a codec."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ur_nodes.codecs.dialect import time_of
from ur_nodes.ports.values import Result

LARGE = 1 << 24
"""Bytes that are read at once of messages such as pictures: in small pieces they take several times as long."""


@dataclass(frozen=True, slots=True)
class Codec:
    """A kind of value as messages. `fill` writes a value into one; `value_of` reads it, raises ValueError or UserError.

    A message may be filled again for the next value. `buffer` is the number of bytes that are read at once.
    """

    message_class: Any
    fill: Callable[[Any, Any], None]
    value_of: Callable[[Any], Any]
    buffer: int = 1 << 16


@dataclass(frozen=True, slots=True)
class ServiceCodec:
    """A kind of request, and what it is answered with, as the messages of a service.

    `response` raises ServiceFailureError where a failure cannot be told otherwise.
    """

    service_class: Any
    request: Callable[[Any], Any]
    request_of: Callable[[Any], Any]
    response: Callable[[Result], Any]
    result_of: Callable[[Any], Result]


def fill_header(message: Any, stamp: int, frame: str) -> None:
    """Write a message's header."""
    message.header.stamp = time_of(stamp)
    message.header.frame_id = frame


def frame_of(message: Any) -> str:
    """The frame of a message, without the slash that tf once had."""
    return str(message.header.frame_id).lstrip("/")
