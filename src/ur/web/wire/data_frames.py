"""Frames of data between the robot's process and the server: for one page, or for all, by a key.

A newer frame of a key replaces an unsent one, so that a slow page gets the newest data. Answers have no key and are all
delivered.
"""

import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass

_HEAD = struct.Struct("<IB")

ALL = 0
"""The number that stands for all pages."""


@dataclass(frozen=True, slots=True)
class DataFrame:
    """A data frame for the page with a number, or for `ALL`; `body` is sent to the page unchanged."""

    page: int
    key: str
    body: bytes


def pack_frame(page: int, key: str, body: bytes) -> bytes:
    """Encode a frame; `key` has at most 255 bytes."""
    name = key.encode()[:255]
    return _HEAD.pack(page, len(name)) + name + body


def pack_json(page: int, key: str, value: Mapping[str, object]) -> bytes:
    """Encode a frame with a JSON object, which contains finite numbers only. Raises ValueError."""
    return pack_frame(page, key, json.dumps(value, separators=(",", ":"), allow_nan=False).encode())


def unpack_frame(data: bytes) -> DataFrame:
    """Decode a frame. Raises ValueError for invalid bytes."""
    if len(data) < _HEAD.size or len(data) < _HEAD.size + data[_HEAD.size - 1]:
        raise ValueError(f"frame of {len(data)} bytes")
    page, length = _HEAD.unpack_from(data)
    end = _HEAD.size + length
    return DataFrame(page, data[_HEAD.size : end].decode("utf-8", "replace"), data[end:])
