"""The state of a stored map before a change by hand, to bring it back."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from ur.maps.change import next_graph_name
from ur.maps.picture_file import write_picture
from ur.maps.record import MapRecord
from ur.maps.store import MapStore
from ur.maps.zone_mask import write_masks
from ur.source.diagnostic import UserError, error
from ur.source.replace import replace_file
from ur.worlds.map_file import MapImage, read_map


@dataclass(frozen=True, slots=True, eq=False)
class MapState:
    """A map as it was: record, picture, and the bytes of its pose graph and of its waypoints; None: no such file."""

    record: MapRecord
    image: MapImage
    graph: bytes | None
    waypoints: bytes | None


def read_state(store: MapStore, name: str, waypoints: Path) -> MapState:
    """Read the state of a map. Raises UserError, or OSError."""
    record, image = store.record(name), read_map(store.picture(name))
    graph = (store.path(name) / record.graph).read_bytes() if record.graph else None
    return MapState(record, image, graph, waypoints.read_bytes() if waypoints.exists() else None)


def restore_state(store: MapStore, name: str, waypoints: Path, state: MapState, left: MapRecord) -> None:
    """Bring a state back. `left` is the record that the change has left.

    Raises UserError: another program has changed the map since; then nothing is changed. Or OSError.
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
