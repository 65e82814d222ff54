"""Binary frames of the robot's state: encoded once by the robot's process, forwarded unchanged, decoded by the page.

A frame begins with its key (kind, layer, column, row; little endian), and a newer frame of a key replaces the older
one. So a slow viewer gets the newest state, not a queue. `static/wire.js` decodes them.
"""

import json
import math
import struct
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum

from ur.web.wire.layers import Layer as Layer

_KEY = struct.Struct("<BBhh")
_POSE = struct.Struct("<7f")
_STAMP = struct.Struct("<d")
_ANCHOR = struct.Struct("<2f")
_GRID = struct.Struct("<I4f2i2I")
_GENERATION = struct.Struct("<I")
LENGTH = struct.Struct("<I")
"""The length of the frame that follows, where frames follow one another in a stream."""

NOTHING_RUNS = b""
"""In place of a frame of the robot's process: the graph holds only nodes of pages."""

TILE = 256
"""Cells along each side of a tile."""

UNIT = 0.005
"""Metres: the unit of points."""

LONGEST = 1 << 22
"""Bytes of the longest frame."""

_MOST = (2.0 - 2.0**-23) * 2.0**127  # the largest number of 32 bits
_WHOLE = (1 << 31) - 1


class Kind(IntEnum):
    """The kind of a frame. `tools/make_wire_numbers.py` writes the numbers for the page."""

    SERVER = 0
    STATE = 1
    POSE = 2
    POINTS = 3
    GRID = 4
    TILE = 5
    PLACES = 6
    OVERLAY = 7
    VALUES = 8
    FIELDS = 9
    ZONES = 16
    CAMERA = 17


Key = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True)
class PoseSample:
    """The robot at one moment in the map frame: m, rad, m/s, rad/s; `nan` if unknown.

    `age` is the time since the last transform, `link_age` that of the newest challenge of the mux, both in s.
    """

    x: float = math.nan
    y: float = math.nan
    yaw: float = math.nan
    speed: float = 0.0
    turn: float = 0.0
    age: float = math.inf
    link_age: float = math.inf


@dataclass(frozen=True, slots=True)
class GridFrame:
    """Extent of a grid on a lattice of cells: `origin` (m, m, rad) is the corner of the lattice's cell (0, 0).

    The grid covers `width` x `height` cells from (`column`, `row`) on. Tiles of another `generation` are invalid.
    """

    generation: int
    resolution: float
    origin: tuple[float, float, float]
    column: int
    row: int
    width: int
    height: int


def key_of(frame: bytes) -> Key:
    """Return the key of a frame. Raises ValueError if it is too short."""
    if len(frame) < _KEY.size:
        raise ValueError(f"frame of {len(frame)} bytes, expected at least {_KEY.size}")
    kind, layer, x, y = _KEY.unpack_from(frame)
    return kind, layer, x, y


def json_frame(kind: Kind, value: Mapping[str, object], layer: Layer = Layer.NONE) -> bytes:
    """Encode a JSON object as a frame."""
    return _KEY.pack(kind, layer, 0, 0) + json.dumps(value, separators=(",", ":"), ensure_ascii=False).encode()


def pose_frame(sample: PoseSample) -> bytes:
    """Encode a pose as a frame. Numbers beyond 32 bits become the largest ones."""
    numbers = (sample.x, sample.y, sample.yaw, sample.speed, sample.turn, sample.age, sample.link_age)
    return _KEY.pack(Kind.POSE, 0, 0, 0) + _POSE.pack(*map(_single, numbers))


def camera_frame(stamp: float, jpeg: bytes) -> bytes:
    """Encode a picture, taken at `stamp` (s since 1970), as a frame."""
    return _KEY.pack(Kind.CAMERA, Layer.CAMERA, 0, 0) + _STAMP.pack(stamp) + jpeg


def points_frame(layer: Layer, points: Sequence[Sequence[float]]) -> bytes:
    """Encode points (n, 2) in m: 16 bits each in units of `UNIT` from the first, so within 163 m of it."""
    key = _KEY.pack(Kind.POINTS, layer, 0, 0)
    good = [(x, y) for x, y in points if math.isfinite(x) and math.isfinite(y)]
    if not good:
        return key + _ANCHOR.pack(0.0, 0.0)
    x0, y0 = _ANCHOR.unpack(_ANCHOR.pack(*map(_single, good[0])))
    numbers = [number for x, y in good for number in (_steps(x - x0), _steps(y - y0))]
    return key + _ANCHOR.pack(x0, y0) + struct.pack(f"<{len(numbers)}h", *numbers)


def grid_frame(layer: Layer, grid: GridFrame) -> bytes:
    """Encode a grid's extent as a frame. Numbers beyond 32 bits become the largest ones."""
    corner = (max(-_WHOLE, min(_WHOLE, each)) for each in (grid.column, grid.row))
    lengths = map(_single, (grid.resolution, *grid.origin))
    return _KEY.pack(Kind.GRID, layer, 0, 0) + _GRID.pack(grid.generation, *lengths, *corner, grid.width, grid.height)


def tile_frame(layer: Layer, generation: int, column: int, row: int, cells: bytes) -> bytes:
    """Encode a tile, `TILE` x `TILE` cells row by row from the lower left: int8, -1 unknown, 0 to 100."""
    if len(cells) != TILE * TILE:
        raise ValueError(f"tile of {len(cells)} cells, expected {TILE * TILE}")
    return _KEY.pack(Kind.TILE, layer, column, row) + _GENERATION.pack(generation) + zlib.compress(cells, 3)


def generation_of(frame: bytes) -> int:
    """Return the generation of a grid or a tile."""
    number: int = _GENERATION.unpack_from(frame, _KEY.size)[0]
    return number


def _steps(metres: float) -> int:
    return round(max(-32768.0, min(32767.0, metres / UNIT)))


def _single(number: float) -> float:
    """Limit a finite number to the range of 32-bit floats, which `struct` requires."""
    return max(-_MOST, min(_MOST, number)) if math.isfinite(number) else number
