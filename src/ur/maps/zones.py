"""Zones of maps: their storage, and changes of them, for every user interface."""

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import chain
from pathlib import Path

from ur.maps.names import PLACE_NAME, PLACE_RULE, is_map_name
from ur.maps.record import LEAST_PERCENT, MOST_CORNERS, MOST_ZONES, Zone, ZoneKind, read_record
from ur.maps.store import PICTURE, MapStore, own_store
from ur.maps.zone_mask import area_of, write_masks
from ur.source.diagnostic import UserError, user_error
from ur.source.suggest import did_you_mean
from ur.source.user_folders import user_folder
from ur.worlds.cells import CellFrame
from ur.worlds.map_file import read_map

Point = tuple[float, float]

_FARTHEST = 10_000.0  # m
_SMALLEST = 0.01  # m^2


def find_home(map_file: Path, environment: Mapping[str, str]) -> tuple[MapStore, str]:
    """Return the store and the name under which the zones of a map are stored.

    Those of a stored map are in its record. Those of any other map, which may be read-only, are in a folder of the
    user, named after the map's file.
    """
    store = own_store(environment)
    file = map_file.resolve()
    if file.name == PICTURE and file.parent.parent == store.folder.resolve() and is_map_name(file.parent.name):
        return store, file.parent.name
    stem = re.sub(r"[^A-Za-z0-9_.-]", "_", map_file.stem).rstrip(".")
    name = stem if is_map_name(stem) else f"map-{stem}"[:64].rstrip(".-")
    return MapStore(Path(user_folder("XDG_DATA_HOME", environment), "ubiquity_launches", "zones")), name


def make_zone(name: str, kind: ZoneKind, points: Iterable[Point], percent: int = 0) -> Zone:
    """Return a zone with corners (m); two opposite corners stand for a rectangle. Raises UserError."""
    corners = list(points)
    if not PLACE_NAME.fullmatch(name):
        raise _bad(f"{name[:60]!r} is not a name of a zone, expected {PLACE_RULE}")
    if not all(math.isfinite(value) and abs(value) <= _FARTHEST for point in corners for value in point):
        raise _bad(f"a corner of zone {name!r} is farther away than {_FARTHEST:g} m, expected metres in the map frame")
    if kind == "speed" and not LEAST_PERCENT <= percent < 100:
        raise _bad(f"{percent} percent for zone {name!r}, expected {LEAST_PERCENT} to 99 percent of the highest speed")
    if not 2 <= len(corners) <= MOST_CORNERS:
        raise _bad(f"{len(corners)} corners for zone {name!r}, expected 2 to {MOST_CORNERS}: X Y X Y ...")
    if len(corners) == 2:
        (left, low), (right, high) = corners
        corners = [(left, low), (right, low), (right, high), (left, high)]
    if area_of(corners) < _SMALLEST:
        raise _bad(f"zone {name!r} has no area, expected corners round {_SMALLEST:g} square metres or more")
    return Zone(name, kind, tuple(corners), percent if kind == "speed" else 0)


def put_zone(store: MapStore, name: str, zone: Zone, plan: CellFrame) -> bool:
    """Store a zone of a map, in place of one with the same name; return whether it is new.

    `plan` are the cells of the map. Raises UserError if the map is in use or has too many zones; or OSError.
    """
    with store.claim(name):
        record = store.record(name)
        others = tuple(each for each in record.zones if each.name != zone.name)
        if len(others) >= MOST_ZONES:
            raise _bad(f"the map has {MOST_ZONES} zones, expected fewer")
        zones = (*others, zone)
        store.write_record(name, replace(record, zones=zones))
        write_masks(store.path(name), zones, plan)
        return len(others) == len(record.zones)


def delete_zone(store: MapStore, name: str, zone: str, plan: CellFrame) -> None:
    """Delete a zone of a map. Raises UserError if it does not exist, or the map is in use; or OSError."""
    with store.claim(name):
        record = store.record(name)
        names = [each.name for each in record.zones]
        if zone not in names:
            near = did_you_mean(zone, names)
            known = ", ".join(names) or "none yet"
            help_ = f"did you mean {near!r}?" if near else "ur maps edit --help"
            raise user_error(f"unknown zone {zone[:60]!r}, expected one of: {known}", rule="unknown-zone", help=help_)
        zones = tuple(each for each in record.zones if each.name != zone)
        store.write_record(name, replace(record, zones=zones))
        write_masks(store.path(name), zones, plan)


def draw_masks(folder: Path) -> None:
    """Write the masks of the zones in the record of the map in a folder. Raises UserError, or OSError."""
    zones = read_record(folder).zones
    if zones:
        write_masks(folder, zones, read_map(folder / PICTURE))


def join_zones(zones: Iterable[Zone], others: Iterable[Zone]) -> tuple[Zone, ...]:
    """Join the zones of two maps; zones of the second map whose name is taken are renamed."""
    joined = list(zones)
    for zone in others:
        taken = {each.name for each in joined}
        numbers = (f"{zone.name[:36]}-{number}" for number in range(2, MOST_ZONES + 2))
        joined.append(replace(zone, name=next(each for each in chain((zone.name,), numbers) if each not in taken)))
    return tuple(joined[:MOST_ZONES])


def describe_zone(zone: Zone) -> str:
    """Describe a zone in a line."""
    rule = "keep out" if zone.kind == "keep-out" else f"at most {zone.percent} % of the highest speed"
    return f"zone {zone.name}: {rule}, {area_of(zone.points):.1f} square metres"


def fresh_zone_name(kind: ZoneKind, zones: Iterable[Zone]) -> str:
    """Return a free name for a zone: `keep-out`, then `keep-out-2` and so on; `slow` for a speed zone."""
    taken = {each.name for each in zones}
    stem: str = "slow" if kind == "speed" else kind
    name, number = stem, 1
    while name in taken:
        number += 1
        name = f"{stem}-{number}"
    return name


def _bad(message: str) -> UserError:
    return user_error(message, rule="bad-zone", help="ur maps edit --help")
