"""Requests of pages that change the map and its annotations: places, zones and walls."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

from ur.maps.names import is_map_name
from ur.maps.record import MOST_STROKES, WIDEST_STROKE, MapEdit
from ur.web.wire.reading import Coordinate, Heading, Name, PageRequest

MOST_CORNERS = 32
"""Corners of a zone."""

LEAST_WIDTH = 0.01
"""m, of the brush for walls."""

_MapName = Annotated[str, Meta(description="the name of a map")]
_CORNERS = f"x, y, x, y, ... of 3 to {MOST_CORNERS} corners"
_STROKES = f"1 to {MOST_STROKES}, each 0 or 1, a width, and x, y, x, y, ... of 2 points or more"


class NamePlace(PageRequest, frozen=True, tag="name_place"):
    """Name a pose in the map frame, or move the place with this name."""

    place: Name
    x: Coordinate
    y: Coordinate
    yaw: Heading


class ForgetPlace(PageRequest, frozen=True, tag="forget_place"):
    """Delete a place."""

    place: Name


@dataclass(frozen=True, slots=True)
class PutZone:
    """Create a zone, or change the one with this name.

    `percent` of the highest speed; 0 for a keep-out zone. `corners` are x, y in m in the map frame.
    """

    zone: str
    percent: int
    corners: tuple[tuple[float, float], ...]


class DeleteZone(PageRequest, frozen=True, tag="delete_zone"):
    """Delete a zone."""

    zone: Name


class SaveMap(PageRequest, frozen=True, tag="save_map"):
    """Save the map under construction."""


@dataclass(frozen=True, slots=True)
class DrawWalls:
    """Draw and erase walls of the map in use, which has to be the one that the page shows."""

    map: str
    strokes: tuple[MapEdit, ...]


class RestoreWalls(PageRequest, frozen=True, tag="restore_walls"):
    """Restore the map in use to its state before the last DrawWalls."""

    map: _MapName

    def __post_init__(self) -> None:
        _check_map(self.map)


class PackedZone(PageRequest, frozen=True, tag="put_zone"):
    """A PutZone as the page encodes it: x, y, x, y, ... of the corners."""

    zone: Name
    percent: Annotated[int, Meta(ge=0, le=99)]
    corners: Annotated[tuple[Coordinate, ...], Meta(min_length=6, max_length=2 * MOST_CORNERS, description=_CORNERS)]

    def __post_init__(self) -> None:
        if len(self.corners) % 2:
            raise ValueError(f"corners: expected {_CORNERS}")

    def unpack(self) -> PutZone:
        """Return the decoded request."""
        return PutZone(self.zone, self.percent, _pair(self.corners))


class PackedWalls(PageRequest, frozen=True, tag="draw_walls"):
    """A DrawWalls as the page encodes it: a stroke is 1 to erase or 0, the width, and x, y, x, y, ... of its points."""

    map: _MapName
    strokes: Annotated[
        tuple[Annotated[tuple[Coordinate, ...], Meta(min_length=6)], ...],
        Meta(min_length=1, max_length=MOST_STROKES, description=_STROKES),
    ]

    def __post_init__(self) -> None:
        _check_map(self.map)
        if any(len(each) % 2 or each[0] not in (0.0, 1.0) for each in self.strokes):
            raise ValueError(f"strokes: expected {_STROKES}")
        if not all(LEAST_WIDTH <= each[1] <= WIDEST_STROKE for each in self.strokes):
            raise ValueError(f"strokes: expected a width from {LEAST_WIDTH:g} to {WIDEST_STROKE:g} m")

    def unpack(self) -> DrawWalls:
        """Return the decoded request."""
        edits = (MapEdit("erase" if erase else "wall", _pair(flat), width) for erase, width, *flat in self.strokes)
        return DrawWalls(self.map, tuple(edits))


MapRequest = NamePlace | ForgetPlace | PutZone | DeleteZone | SaveMap | DrawWalls | RestoreWalls
PackedMapRequest = NamePlace | ForgetPlace | PackedZone | DeleteZone | SaveMap | PackedWalls | RestoreWalls


def _check_map(name: str) -> None:
    if not is_map_name(name):
        raise ValueError("map: expected the name of a map")


def _pair(flat: Sequence[float]) -> tuple[tuple[float, float], ...]:
    return tuple(zip(flat[::2], flat[1::2], strict=True))
