"""Editor of a stored map, step by step: marked points, changes, undo. For every user interface."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from ur.maps.change import Point, add_edit, make_edit, move_map, name_place, next_graph_name, propose, read_places
from ur.maps.edit import Origin
from ur.maps.picture_file import write_picture
from ur.maps.record import EditKind, MapRecord, Zone, ZoneKind
from ur.maps.store import MapStore
from ur.maps.zone_mask import is_inside, write_masks
from ur.maps.zones import delete_zone, describe_zone, fresh_zone_name, make_zone, put_zone
from ur.source.diagnostic import UserError, error
from ur.source.replace import replace_file
from ur.worlds.map_file import MapImage, read_map

_MOST_STEPS = 50  # that can be undone


@dataclass(frozen=True, slots=True)
class _Step:
    """A change: the state `before` it, and the record `left` after it, to detect later changes by other programs."""

    title: str
    before: StoredMapState
    left: MapRecord


class EditSession:
    """Changes one map.

    Each change is on the disk when its method returns. The methods return a line that describes the change. They raise
    UserError or OSError without a change.
    """

    def __init__(self, store: MapStore, name: str, waypoints: Path) -> None:
        self.name = store.resolve(name)
        self.marks: tuple[Point, ...] = ()
        self._store = store
        self._waypoints = waypoints
        self._steps: list[_Step] = []

    def image(self) -> MapImage:
        """Read the present picture of the map."""
        return read_map(self._store.picture(self.name))

    def places(self) -> dict[str, Origin]:
        """Read the named places: x, y in m, and degrees."""
        return read_places(self._waypoints)

    def mark(self, x: float, y: float) -> None:
        """Mark a point, m, for the next change."""
        self.marks = (*self.marks, (x, y))

    def clear(self) -> None:
        """Remove the marked points."""
        self.marks = ()

    def draw(self, kind: EditKind) -> str:
        """Draw with the points: a wall along them, or erase inside of them; two points are corners of a rectangle."""
        edit = make_edit(kind, list(self.marks))
        with self._undoable(kind):
            count = add_edit(self._store, self.name, edit)
        self.marks = ()
        return f"{kind}: {count} cells changed"

    def zones(self) -> tuple[Zone, ...]:
        """Read the zones."""
        return self._store.record(self.name).zones

    def zone(self, kind: ZoneKind, percent: int = 0) -> str:
        """Create a zone from the points, two are corners of a rectangle, under a free name."""
        zone = make_zone(fresh_zone_name(kind, self.zones()), kind, self.marks, percent)
        with self._undoable(f"zone {zone.name}"):
            put_zone(self._store, self.name, zone, self.image())
        self.marks = ()
        return describe_zone(zone)

    def delete_zone(self, x: float, y: float) -> str:
        """Delete the zone that contains a point; of several, the latest one."""
        found = [each.name for each in self.zones() if is_inside((x, y), each.points)]
        if not found:
            raise UserError(error(f"no zone at ({x:.2f}, {y:.2f}), expected a point in one", rule="unknown-zone"))
        with self._undoable(f"zone {found[-1]} deleted"):
            delete_zone(self._store, self.name, found[-1], self.image())
        return f"zone {found[-1]} is deleted"

    def rotate(self) -> str:
        """Rotate the map so that its walls are aligned with the axes."""
        turn = propose(self._store, self.name)
        if not turn:
            return "the walls lie along the axes; nothing to do"
        with self._undoable("rotate"):
            move_map(self._store, self.name, (0.0, 0.0, turn), self._waypoints)
        self.marks = ()
        return f"turned by {math.degrees(turn):.1f} degrees"

    def set_origin(self, x: float, y: float) -> str:
        """Make a point (m) the origin (0, 0)."""
        with self._undoable("origin"):
            move_map(self._store, self.name, (-x, -y, 0.0), self._waypoints)
        self.marks = ()
        return f"({x:.2f}, {y:.2f}) is (0, 0) now"

    def place(self, title: str, x: float, y: float, degrees: float = 0.0) -> str:
        """Name a place."""
        with self._undoable(f"place {title}"):
            name_place(self._store, self.name, self._waypoints, title, (x, y, degrees))
        return f"{title} is at {x:.2f} {y:.2f} {degrees:g}"

    def undo(self) -> str:
        """Undo the last change."""
        if not self._steps:
            raise UserError(error("no change to undo, expected one made here", rule="not-undone"))
        step = self._steps[-1]
        restore_state(self._store, self.name, self._waypoints, step.before, step.left)
        self._steps.pop()
        return f"{step.title}: undone"

    @contextmanager
    def _undoable(self, title: str) -> Iterator[None]:
        """Record for `undo` the change that is made inside; nothing if it raises an exception."""
        before = read_state(self._store, self.name, self._waypoints)
        yield
        self._steps = [*self._steps, _Step(title, before, self._store.record(self.name))][-_MOST_STEPS:]


@dataclass(frozen=True, slots=True, eq=False)
class StoredMapState:
    """The state of a map: record, picture, and the bytes of its pose graph and waypoints; None: no such file."""

    record: MapRecord
    image: MapImage
    graph: bytes | None
    waypoints: bytes | None


def read_state(store: MapStore, name: str, waypoints: Path) -> StoredMapState:
    """Read the state of a map. Raises UserError, or OSError."""
    record, image = store.record(name), read_map(store.picture(name))
    graph = (store.path(name) / record.graph).read_bytes() if record.graph else None
    return StoredMapState(record, image, graph, waypoints.read_bytes() if waypoints.exists() else None)


def restore_state(store: MapStore, name: str, waypoints: Path, state: StoredMapState, left: MapRecord) -> None:
    """Restore a state. `left` is the record after the change.

    Raises UserError, without a change, if another program has changed the map since; or OSError.
    """
    with store.claim(name):
        now = store.record(name)
        if now != left:
            raise UserError(
                error(
                    f"map {name!r} was changed by another program, expected the map of the last change here",
                    rule="not-undone",
                    help="open it again: ur maps edit",
                    subject=name,
                )
            )
        record = state.record
        if state.graph is not None:
            record = replace(record, graph=next_graph_name(now.graph, now.scans))
            replace_file(store.path(name) / record.graph, state.graph)
        store.write_record(name, record)
        image = state.image
        write_picture(store.path(name) / "map", image.values, image.resolution, image.origin)
        if now.zones or record.zones:
            write_masks(store.path(name), record.zones, image)
        if state.waypoints is not None:
            replace_file(waypoints, state.waypoints)
        else:
            waypoints.unlink(missing_ok=True)
        if now.graph and now.graph != record.graph:
            (store.path(name) / now.graph).unlink(missing_ok=True)
