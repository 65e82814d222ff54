"""The record of a stored map, `map.json`: its files, and its description for the user."""

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

from msgspec import Meta

from ur.maps.names import PLACE_NAME, PLACE_RULE
from ur.source.diagnostic import UserError, user_error
from ur.source.foreign.files import read_file
from ur.source.foreign.json_values import convert_json, read_json

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
EditKind = Literal["erase", "wall", "keep-out"]
_Metres = Annotated[float, Meta(ge=-1e6, le=1e6)]
_Point = tuple[_Metres, _Metres]
_Moment = Annotated[float, Meta(ge=-1e11, le=1e11)]
_NPZ = r"(graph|scans)_[0-9]{1,6}\.npz"
_File = Annotated[str, Meta(pattern=rf"^{_NPZ}\Z")]
_ZoneName = Annotated[
    str, Meta(pattern=rf"^(?:{PLACE_NAME.pattern})\Z", description=f"the name of a zone, {PLACE_RULE}")
]


@dataclass(frozen=True, slots=True)
class MapEdit:
    """A manual change: `erase` a polygon, draw a `wall` along a line, or fill a `keep-out` polygon.

    `points` are x, y in m in the frame of the map. With a `width` (m, 0: none) `erase` and `wall` are the stroke of a
    round brush along a line.
    """

    kind: EditKind
    points: Annotated[tuple[_Point, ...], Meta(max_length=MOST_POINTS)]
    width: Annotated[float, Meta(ge=0.0, le=WIDEST_STROKE)] = 0.0


@dataclass(frozen=True, slots=True)
class Zone:
    """A named area that the robot does not enter, or in which it drives slowly: `percent` of its highest speed.

    `points` are the corners of a polygon, x, y in m in the frame of the map. `percent` of a keep-out zone is 0.
    """

    name: _ZoneName
    kind: ZoneKind
    points: Annotated[tuple[_Point, ...], Meta(min_length=3, max_length=MOST_CORNERS)]
    percent: int = 0


@dataclass(frozen=True, slots=True)
class MapRecord:
    """The record of a map. `robot` is the robot that made it; `made` and `changed` are seconds since 1970.

    `graph` and `scans` name files beside the record, '' and () for a map without scans; `keyframes` is their number.
    `edits` are applied in order to the picture drawn from the scans. `zones` are not in the picture: localisation does
    not see them.
    """

    robot: str = ""
    made: _Moment = 0.0
    changed: _Moment = 0.0
    keyframes: Annotated[int, Meta(ge=0, le=1_000_000)] = 0
    resolution: Annotated[float, Meta(ge=0.005, le=1.0)] = 0.05
    threshold: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.25
    graph: Annotated[str, Meta(pattern=rf"^({_NPZ})?\Z")] = ""
    scans: Annotated[tuple[_File, ...], Meta(max_length=MOST_FILES)] = ()
    edits: Annotated[tuple[MapEdit, ...], Meta(max_length=MOST_EDITS)] = ()
    zones: Annotated[tuple[Zone, ...], Meta(max_length=MOST_ZONES)] = ()


def render_record(record: MapRecord) -> str:
    """Return the text of a record."""
    return json.dumps({"version": 1, **asdict(record)}, indent=1) + "\n"


def read_record(folder: Path) -> MapRecord:
    """Read the record in the folder of a map; an empty one if there is no file. Raises UserError for an invalid one."""
    path = folder / RECORD
    try:
        data = read_file(path, LARGEST)
    except FileNotFoundError:
        return MapRecord()
    except OSError as problem:
        raise _bad(path, (problem.strerror or str(problem)).lower()) from None
    return parse_record(data, path)


def parse_record(data: bytes, path: Path) -> MapRecord:
    """Parse the text of a record, which is untrusted. Raises UserError, which names `path`."""
    try:
        found = read_json(data, dict[str, object], LARGEST)
        if found.get("version") != 1:
            raise _bad(path, "not the record of a map, expected a mapping with version 1")
        record = convert_json(found, MapRecord)
        edits, zones = tuple(map(_check_edit, record.edits)), tuple(map(_check_zone, record.zones))
    except ValueError as problem:
        raise _bad(path, f"not the record of a map: {str(problem)[:80]}") from None
    return replace(record, robot=record.robot[:200], edits=edits, zones=zones)


def read_zone(found: object) -> Zone:
    """Parse a zone from an untrusted JSON value, as `dataclasses.asdict` writes it.

    Raises ValueError, with a clause that names the expected value.
    """
    return _check_zone(convert_json(found, Zone))


def read_edit(found: object) -> MapEdit:
    """Parse an edit from an untrusted JSON value, as `dataclasses.asdict` writes it.

    Raises ValueError, with a clause that names the expected value.
    """
    return _check_edit(convert_json(found, MapEdit))


def _check_zone(zone: Zone) -> Zone:
    if zone.kind == "speed" and not LEAST_PERCENT <= zone.percent < 100:
        raise ValueError(f"the speed of a zone, expected {LEAST_PERCENT} to 99 percent")
    return zone if zone.kind == "speed" else replace(zone, percent=0)


def _check_edit(edit: MapEdit) -> MapEdit:
    if edit.width and edit.kind == "keep-out":
        raise ValueError("a keep-out edit with a width, expected a polygon")
    if len(edit.points) < (2 if edit.width or edit.kind == "wall" else 3):
        raise ValueError(f"{len(edit.points)} points of an edit, expected more")
    return edit


def _bad(path: Path, what: str) -> UserError:
    return user_error(f"'{path}': {what}", rule="bad-map", help="copy the map again, or delete it", subject=str(path))
