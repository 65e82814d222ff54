"""Manual changes of a stored map, for every user interface: edits, rotations, and the resulting files."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ur.maps.edit import Origin, apply_edits, move_graph, move_point, move_record, propose_turn, turn_values
from ur.maps.names import PLACE_NAME, PLACE_RULE, read_places, write_places
from ur.maps.picture_file import write_picture
from ur.maps.record import LARGEST, MOST_EDITS, MOST_POINTS, EditKind, MapEdit, MapRecord, render_record
from ur.maps.scan_file import encode_graph, read_graph
from ur.maps.store import MapStore
from ur.maps.zone_mask import write_masks
from ur.source.diagnostic import UserError, user_error
from ur.source.replace import replace_file
from ur.worlds.map_file import MapImage, read_map

Point = tuple[float, float]

_FARTHEST = 10_000.0  # m


def make_edit(kind: EditKind, points: list[Point]) -> MapEdit:
    """Return an edit with points (m); two opposite corners stand for a rectangle. Raises UserError."""
    if not all(math.isfinite(value) and abs(value) <= _FARTHEST for point in points for value in point):
        raise _bad(f"a point of {kind} is farther away than {_FARTHEST:g} m, expected metres in the frame of the map")
    if len(points) < 2 or len(points) > MOST_POINTS:
        raise _bad(f"{len(points)} points for {kind}, expected 2 to {MOST_POINTS}: X Y X Y ...")
    if kind != "wall" and len(points) == 2:
        (left, low), (right, high) = points
        points = [(left, low), (right, low), (right, high), (left, high)]
    return MapEdit(kind, tuple(points))


def add_edit(store: MapStore, name: str, edit: MapEdit) -> int:
    """Apply an edit to a map; return the number of changed cells. Raises UserError, or OSError."""
    name = store.resolve(name)
    with store.claim(name):
        record, image = store.record(name), read_map(store.picture(name))
        drawn = write_edits(store, name, add_to_record(name, record, [edit]), image, [edit])
        return int((drawn.values != image.values).sum())


def add_to_record(name: str, record: MapRecord, edits: Sequence[MapEdit]) -> MapRecord:
    """Return the record of a map with more edits. Raises UserError if there would be too many."""
    after = replace(record, edits=(*record.edits, *edits))
    if len(after.edits) > MOST_EDITS or len(render_record(after)) > LARGEST:
        raise _bad(f"map {name!r} has {len(record.edits)} edits, expected fewer, or shorter ones")
    return after


def write_edits(store: MapStore, name: str, record: MapRecord, image: MapImage, edits: Sequence[MapEdit]) -> MapImage:
    """Draw edits on the picture of a claimed map, and write it; `record` contains them. Raises OSError."""
    drawn = replace(image, values=apply_edits(image.values, image.resolution, image.origin, edits))
    # The record first: an edit that is made twice changes nothing more.
    store.write_record(name, record)
    _write(store, name, drawn, image.origin)
    return drawn


def propose(store: MapStore, name: str) -> float:
    """Return the rotation (rad) that aligns the walls of a map with the axes. Raises UserError."""
    image = read_map(store.picture(store.resolve(name)))
    return propose_turn(image.values, image.resolution, image.origin)


def move_map(store: MapStore, name: str, motion: Origin, waypoints: Path) -> None:
    """Move a map in its frame: points p become motion * p. Its edits, zones and waypoints move with it.

    Raises UserError, or OSError.
    """
    name = store.resolve(name)
    if not all(math.isfinite(value) and abs(value) <= _FARTHEST for value in motion):
        raise _bad(f"the map would move by more than {_FARTHEST:g} m, expected metres and degrees")
    with store.claim(name):
        record, image = store.record(name), read_map(store.picture(name))
        places = read_places(waypoints)
        if motion[2]:
            try:
                values, origin = turn_values(image.values, image.resolution, image.origin, motion)
            except ValueError as problem:
                raise _bad(f"map {name!r}: {problem}") from None
            image = replace(image, values=values)
        else:
            x, y, yaw = image.origin
            origin = (x + motion[0], y + motion[1], yaw)
        moved = move_record(record, motion)
        if record.graph:
            graph = move_graph(read_graph(store.path(name) / record.graph), motion)
            moved = replace(moved, graph=next_graph_name(record.graph, record.scans))
            replace_file(store.path(name) / moved.graph, encode_graph(graph))
        store.write_record(name, moved)
        _write(store, name, image, origin)
        if record.zones:
            write_masks(store.path(name), moved.zones, read_map(store.picture(name)))
        if places:
            write_places(waypoints, move_places(places, motion))
        if record.graph:
            (store.path(name) / record.graph).unlink(missing_ok=True)


def name_place(store: MapStore, name: str, waypoints: Path, place: str, pose: Origin) -> None:
    """Name a place of a map: x, y in m, and degrees. Raises UserError, or OSError."""
    if not PLACE_NAME.fullmatch(place):
        raise _bad(f"{place[:60]!r} is not a name of a place, expected {PLACE_RULE}")
    if not all(math.isfinite(value) and abs(value) <= _FARTHEST for value in pose):
        raise _bad(f"the place is farther away than {_FARTHEST:g} m, expected metres in the frame of the map")
    with store.claim(store.resolve(name)):
        write_places(waypoints, {**read_places(waypoints), place: pose})


def move_places(places: Mapping[str, Origin], motion: Origin) -> dict[str, Origin]:
    """Return places (m, m, degrees) on a map that is moved by motion (m, m, rad)."""
    return {
        each: (*move_point((x, y), motion), math.remainder(degrees + math.degrees(motion[2]), 360.0))
        for each, (x, y, degrees) in places.items()
    }


def _write(store: MapStore, name: str, image: MapImage, origin: Origin) -> None:
    write_picture(store.path(name) / "map", image.values, image.resolution, origin)


def next_graph_name(graph: str, scans: tuple[str, ...]) -> str:
    """Return a file name for a new pose graph of a map with these files."""
    return f"graph_{max(int(each.split('_')[1].split('.')[0]) for each in (graph, *scans)) + 1}.npz"


def _bad(message: str) -> UserError:
    return user_error(message, rule="bad-edit", help="ur maps edit --help")
