"""Requests of pages that change the map and what belongs to it: places, zones and walls."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from ur.maps.names import is_map_name
from ur.maps.record import MOST_STROKES, WIDEST_STROKE, MapEdit
from ur.web.wire.reading import FARTHEST, BadRequestError, read_name, read_number, read_pose

MOST_CORNERS = 32
"""Corners of a zone."""

LEAST_WIDTH = 0.01
"""m, of the brush for walls."""


@dataclass(frozen=True, slots=True)
class NamePlace:
    """Name a pose in the map frame, or move the place that has the name."""

    place: str
    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True)
class ForgetPlace:
    """Delete a place."""

    place: str


@dataclass(frozen=True, slots=True)
class PutZone:
    """Make a zone, or change the one that has the name. `percent` of the highest speed; 0 for a keep-out zone.

    `corners` are x, y in m in the map frame.
    """

    zone: str
    percent: int
    corners: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class DeleteZone:
    """Delete a zone."""

    zone: str


@dataclass(frozen=True, slots=True)
class SaveMap:
    """Save the map that is being made."""


@dataclass(frozen=True, slots=True)
class DrawWalls:
    """Draw and erase walls of the map in use, which has to be the one that the page shows."""

    map: str
    strokes: tuple[MapEdit, ...]


@dataclass(frozen=True, slots=True)
class RestoreWalls:
    """Restore the map in use as it was before the last DrawWalls."""

    map: str


MapRequest = NamePlace | ForgetPlace | PutZone | DeleteZone | SaveMap | DrawWalls | RestoreWalls


def _put_zone(value: Mapping[str, Any]) -> PutZone:
    percent, found = value.get("percent"), value.get("corners")
    if type(percent) is not int or not 0 <= percent < 100:
        raise BadRequestError("percent: expected a whole number from 0 to 99")
    if not isinstance(found, list) or len(found) % 2 or not 6 <= len(found) <= 2 * MOST_CORNERS:
        raise BadRequestError(f"corners: expected x, y, x, y, ... of 3 to {MOST_CORNERS} corners")
    numbers = [read_number({"corners": each}, "corners", FARTHEST) for each in found]
    return PutZone(read_name(value, "zone"), percent, tuple(zip(numbers[::2], numbers[1::2], strict=True)))


def _map(value: Mapping[str, Any]) -> str:
    name = value.get("map")
    if not isinstance(name, str) or not is_map_name(name):
        raise BadRequestError("map: expected the name of a map")
    return name


def _draw_walls(value: Mapping[str, Any]) -> DrawWalls:
    found = value.get("strokes")
    if not isinstance(found, list) or not 0 < len(found) <= MOST_STROKES:
        raise BadRequestError(f"strokes: expected 1 to {MOST_STROKES}")
    return DrawWalls(_map(value), tuple(_stroke(each) for each in found))


def _stroke(found: object) -> MapEdit:
    """A stroke as the page packs it: 1 to erase or 0, the width, and x, y, x, y, ... of its points."""
    if not isinstance(found, list) or len(found) < 6 or len(found) % 2 or found[0] not in (0, 1):
        raise BadRequestError("strokes: expected 0 or 1, a width, and x, y, x, y, ... of 2 points or more")
    width, *numbers = (read_number({"strokes": each}, "strokes", FARTHEST) for each in found[1:])
    if not LEAST_WIDTH <= width <= WIDEST_STROKE:
        raise BadRequestError(f"strokes: expected a width from {LEAST_WIDTH:g} to {WIDEST_STROKE:g} m")
    return MapEdit("erase" if found[0] else "wall", tuple(zip(numbers[::2], numbers[1::2], strict=True)), width)


MAP_READERS: Mapping[str, Callable[[Mapping[str, Any]], MapRequest]] = {
    "name_place": lambda value: NamePlace(read_name(value), *read_pose(value)),
    "forget_place": lambda value: ForgetPlace(read_name(value)),
    "put_zone": _put_zone,
    "delete_zone": lambda value: DeleteZone(read_name(value, "zone")),
    "save_map": lambda _: SaveMap(),
    "draw_walls": _draw_walls,
    "restore_walls": lambda value: RestoreWalls(_map(value)),
}
