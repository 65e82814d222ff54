"""Requests of pages about data of the robot, as JSON. Untrusted until decoded here.

A `Show` names the displayed data, in place of the previous request; the robot's process measures and sends only that. A
question has a number, `id`, which its answer repeats.
"""

import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

from ur.source.foreign.json_values import BadJsonError, Count, ForeignValue, convert_json, read_json
from ur.web.wire.reading import read_numbered

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


LONGEST = 16384
"""Characters of the longest request."""

MOST_MEASURED = 24
"""Topics of one page whose rate is measured."""

MOST_IN_SCENE = 4
"""Topics of clouds and markers that one page shows."""

_Name = Annotated[str, Meta(pattern=r"^/[A-Za-z0-9_/~]{1,200}\Z", description="a full name, such as /scan")]
_Mesh = Annotated[
    str,
    Meta(
        pattern=r"^package://[A-Za-z][A-Za-z0-9_-]{0,99}/[A-Za-z0-9_./ +-]{1,300}\Z",
        description="package://PACKAGE/PATH",
    ),
]


class Show(ForeignValue, frozen=True, tag_field="t", tag="show"):
    """The content of a page: `topics` lists all topics and measures the named ones; `echo` is one to print.

    `status`: diagnostics and the computer. `scene`: frames, and the clouds and markers of these topics.
    """

    topics: Annotated[tuple[_Name, ...], Meta(max_length=MOST_MEASURED)] | None = None
    echo: _Name | None = None
    status: bool = False
    scene: Annotated[tuple[_Name, ...], Meta(max_length=MOST_IN_SCENE)] | None = None


class DescribeModel(ForeignValue, frozen=True, tag_field="t", tag="model"):
    """Return the shapes of the robot."""


class DescribeMesh(ForeignValue, frozen=True, tag_field="t", tag="mesh", rename={"address": "mesh"}):
    """Return a mesh by its address in the robot's description."""

    address: _Mesh


Question = DescribeModel | DescribeMesh


class _NumberOf(ForeignValue, frozen=True):
    id: Count
    n: object = None


@dataclass(frozen=True, slots=True)
class DataEnvelope:
    """A request and its number (0 for `Show`)."""

    number: int
    request: Show | Question


def read_data_request(text: object) -> DataEnvelope:
    """Decode a request. Raises BadRequestError."""
    request, fields = read_numbered(text, Show | Question, LONGEST)
    return DataEnvelope(0 if isinstance(request, Show) else convert_json(fields, _NumberOf).id, request)


def find_number(text: object) -> int:
    """Return the number of a malformed request for its error message; 0 if it has none."""
    try:
        number: int = convert_json(read_json(text, dict[str, object], LONGEST).get("id"), Count)
    except BadJsonError:
        return 0
    return number
