"""The record of a stored map, `map.json`: which files belong to it, and what people want to know of it."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from ur.source.diagnostic import UserError, error
from ur.source.foreign.files import read_file

RECORD = "map.json"
LARGEST = 4_000_000  # bytes of a record
MOST_EDITS = 10_000
MOST_POINTS = 1000  # of an edit
MOST_FILES = 1000
MOST_ZONES = 200
MOST_CORNERS = 100  # of a zone
LEAST_PERCENT = 5
WIDEST_STROKE = 5.0
"""m, of the brush of an edit."""

MOST_STROKES = 100
"""Edits of a change from a page."""

ZoneKind = Literal["keep-out", "speed"]
_ZONE_KINDS: tuple[ZoneKind, ...] = get_args(ZoneKind)
ZONE_NAME = re.compile(r"\w(?:[\w .-]{0,38}[\w.-])?")
"""Names of zones."""

EditKind = Literal["erase", "wall", "keep-out"]
_KINDS: tuple[EditKind, ...] = get_args(EditKind)
_FILE = re.compile(r"(graph|scans)_[0-9]{1,6}\.npz")


@dataclass(frozen=True, slots=True)
class MapEdit:
    """A change made by hand: `erase` a polygon, draw a `wall` along a line, or fill a `keep-out` polygon.

    `points` are x, y in m in the frame of the map. With a `width` (m, 0: none) `erase` and `wall` are the stroke of a
    round brush along a line.
    """

    kind: EditKind
    points: tuple[tuple[float, float], ...]
    width: float = 0.0


@dataclass(frozen=True, slots=True)
class Zone:
    """An area with a name that the robot keeps out of, or drives slowly in: `percent` of its highest speed.

    `points` are the corners of a polygon, x, y in m in the frame of the map. `percent` of a keep-out zone is 0.
    """

    name: str
    kind: ZoneKind
    points: tuple[tuple[float, float], ...]
    percent: int = 0


@dataclass(frozen=True, slots=True)
class MapRecord:
    """`robot` is the robot that made the map; `made` and `changed` are seconds since 1970.

    `graph` and `scans` name files beside the record, '' and () where a map has no scans; `keyframes` is their number.
    `edits` are applied in order to the picture that is drawn from the scans. `zones` are not in the picture:
    localisation does not see them.
    """

    robot: str = ""
    made: float = 0.0
    changed: float = 0.0
    keyframes: int = 0
    resolution: float = 0.05
    threshold: float = 0.25
    graph: str = ""
    scans: tuple[str, ...] = ()
    edits: tuple[MapEdit, ...] = ()
    zones: tuple[Zone, ...] = ()


def render_record(record: MapRecord) -> str:
    """The text of a record."""
    return json.dumps({"version": 1, **asdict(record)}, indent=1) + "\n"


def read_record(folder: Path) -> MapRecord:
    """Read the record in the folder of a map; an empty one where there is none. Raises UserError: not a record."""
    path = folder / RECORD
    try:
        data = read_file(path, LARGEST)
    except FileNotFoundError:
        return MapRecord()
    except OSError as problem:
        raise _bad(path, (problem.strerror or str(problem)).lower()) from None
    return parse_record(data, path)


def parse_record(data: bytes, path: Path) -> MapRecord:
    """Parse the text of a record, which may come from anywhere. Raises UserError, which names `path`."""
    try:
        found = json.loads(data)
    except (ValueError, RecursionError) as problem:
        raise _bad(path, f"not the record of a map: {str(problem)[:80]}") from None
    if not isinstance(found, dict) or found.get("version") != 1:
        raise _bad(path, "not the record of a map, expected a mapping with version 1")
    try:
        return _record(found)
    except (KeyError, TypeError, ValueError) as problem:
        raise _bad(path, f"not the record of a map: {str(problem)[:80]}") from None


def _record(found: Mapping[str, Any]) -> MapRecord:
    graph = _text(found.get("graph", ""))
    scans = tuple(_text(each) for each in _items(found.get("scans", []), MOST_FILES))
    if not all(_FILE.fullmatch(name) for name in (*scans, *([graph] if graph else []))):
        raise ValueError("a name of a file, expected graph_N.npz or scans_N.npz")
    return MapRecord(
        robot=_text(found.get("robot", ""))[:200],
        made=_number(found.get("made", 0.0), 1e11),
        changed=_number(found.get("changed", 0.0), 1e11),
        keyframes=int(_number(found.get("keyframes", 0), 1e6, 0.0)),
        resolution=_number(found.get("resolution", 0.05), 1.0, 0.005),
        threshold=_number(found.get("threshold", 0.25), 1.0, 0.0),
        graph=graph,
        scans=scans,
        edits=tuple(read_edit(each) for each in _items(found.get("edits", []), MOST_EDITS)),
        zones=tuple(read_zone(each) for each in _items(found.get("zones", []), MOST_ZONES)),
    )


def read_zone(found: Any) -> Zone:
    """The zone that a value of JSON describes, as `dataclasses.asdict` writes it; it may come from anywhere.

    Raises ValueError or TypeError, with a clause that says what was expected.
    """
    if not isinstance(found, dict):
        raise TypeError("a zone, expected a mapping")
    name = _text(found.get("name"))
    if not ZONE_NAME.fullmatch(name):
        raise ValueError("the name of a zone, expected at most 40 letters, digits, blanks, '_', '-' and '.'")
    kind = next((each for each in _ZONE_KINDS if each == found.get("kind")), None)
    if kind is None:
        raise ValueError(f"a zone, expected one of {', '.join(_ZONE_KINDS)}")
    percent = found.get("percent", 0)
    if kind == "speed" and not (type(percent) is int and LEAST_PERCENT <= percent < 100):
        raise ValueError(f"the speed of a zone, expected {LEAST_PERCENT} to 99 percent")
    points = _points(found.get("points", []), MOST_CORNERS)
    if len(points) < 3:
        raise ValueError(f"{len(points)} corners of a zone, expected at least 3")
    return Zone(name, kind, points, percent if kind == "speed" else 0)


def read_edit(found: Any) -> MapEdit:
    """The edit that a value of JSON describes, as `dataclasses.asdict` writes it; it may come from anywhere.

    Raises ValueError or TypeError, with a clause that says what was expected.
    """
    if not isinstance(found, dict):
        raise TypeError("an edit, expected a mapping")
    kind = next((each for each in _KINDS if each == found.get("kind")), None)
    if kind is None:
        raise ValueError(f"an edit, expected one of {', '.join(_KINDS)}")
    width = _number(found.get("width", 0.0), WIDEST_STROKE, 0.0)
    if width and kind == "keep-out":
        raise ValueError("a keep-out edit with a width, expected a polygon")
    points = _points(found.get("points", []), MOST_POINTS)
    if len(points) < (2 if width or kind == "wall" else 3):
        raise ValueError(f"{len(points)} points of an edit, expected more")
    return MapEdit(kind, points, width)


def _points(found: Any, most: int) -> tuple[tuple[float, float], ...]:
    points = []
    for each in _items(found, most):
        x, y = (_number(value, 1e6) for value in _items(each, 2))
        points.append((x, y))
    return tuple(points)


def _items(found: Any, most: int) -> list[Any]:
    if not isinstance(found, list) or len(found) > most:
        raise ValueError(f"expected a list with at most {most:,} items")
    return found


def _text(found: Any) -> str:
    if not isinstance(found, str):
        raise TypeError("expected a text")
    return found


def _number(found: Any, largest: float, least: float | None = None) -> float:
    least = -largest if least is None else least
    if isinstance(found, bool) or not isinstance(found, (int, float)) or not math.isfinite(found):
        raise TypeError("expected a number")
    if not least <= found <= largest:
        raise ValueError(f"{found:g}, expected {least:g} to {largest:g}")
    return float(found)


def _bad(path: Path, what: str) -> UserError:
    return UserError(
        error(f"'{path}': {what}", rule="bad-map", help="copy the map again, or delete it", subject=str(path))
    )
