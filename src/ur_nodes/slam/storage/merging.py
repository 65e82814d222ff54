"""Merge two stored maps into a third one: python -I -m ur_nodes ur_nodes.slam.storage.merging FIRST SECOND NAME.

Writes one line of JSON: `name` of the new map, its `keyframes`, the number of `links` between both maps, `place`, the
pose (m, m, rad) of the second map's frame on the new map, whose frame is that of the first, and `changes`, rectangles
(x, y, width, height in m) round places where both differ. Exit code 2 and diagnostics on standard error when they are
not merged; then there is no new map.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING

from ur.maps.edit import move_record
from ur.maps.record import MapRecord
from ur.maps.store import MapStore, own_store
from ur.maps.zones import draw_masks, join_zones
from ur.source.diagnostic import Diagnostic, UserError, error
from ur.source.render import render_human

if TYPE_CHECKING:
    from ur_nodes.slam.merge import NotMerged

_CONTINUE = "ur run make_map map:="


def main(argv: Sequence[str] | None = None) -> int:
    """Read the command line, merge, print the result."""
    parser = argparse.ArgumentParser(prog="merging", description="Merge two stored maps into a third one.")
    parser.add_argument("first", help="its frame is kept")
    parser.add_argument("second", help="where both differ, this one counts as seen later")
    parser.add_argument("name", help="of the new map")
    arguments = parser.parse_args(argv)
    try:
        if find_spec("gtsam") is None:
            raise UserError(error("gtsam is not installed, expected it", rule="no-gtsam", help="ur setup"))
        result = merge_stored(own_store(os.environ), arguments.first, arguments.second, arguments.name)
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics))
        return 2
    except OSError as problem:
        where = problem.filename or arguments.name
        sys.stderr.write(f"error: '{where}' cannot be written: {problem.strerror or problem}\n")
        return 2
    sys.stdout.write(json.dumps(result) + "\n")
    return 0


def _explain(result: NotMerged, first: str, second: str) -> Diagnostic:
    both = f"maps {first!r} and {second!r}"
    if result.reason == "no-scans":
        return error(f"{both}: one has a picture only, expected scans", rule="no-scans", help="make a new map")
    if result.reason == "several-places":
        places = ", ".join(f"({place.x:.1f}, {place.y:.1f})" for place in result.poses[:3])
        message = f"{both} fit together at {len(result.poses)} places equally well: {places}, expected one"
        return error(
            message, rule="not-merged", help=f"continue {first!r} to where the places differ: {_CONTINUE}{first}"
        )
    if result.reason == "contradiction":
        message = f"{both} overlap, but most scans of the overlap do not fit, expected the same walls"
        return error(message, rule="not-merged", help=f"continue one of them: {_CONTINUE}{first}")
    message = f"{both} do not overlap, expected a few metres of the same floor in both"
    return error(message, rule="not-merged", help=f"continue {first!r} until it reaches {second!r}: {_CONTINUE}{first}")


def merge_stored(store: MapStore, first: str, second: str, name: str) -> dict[str, object]:
    """Merge two maps of a store; returns what `main` prints. Raises UserError, OSError."""
    from ur_nodes.slam.map_state import MapState, find_drives
    from ur_nodes.slam.merge import NotMerged, merge_maps
    from ur_nodes.slam.occupancy import OccupancyMap
    from ur_nodes.slam.storage.writer import MapWriter, load_poses

    first, second = store.resolve(first), store.resolve(second)
    states, records = [], []
    for each in (first, second):
        records.append(store.record(each))
        poses, edges, scans = load_poses(store.path(each), records[-1])
        states.append(MapState(poses, edges, scans, find_drives(edges, len(poses))))
    with store.arriving(name) as folder:
        merged = merge_maps(*states)
        if isinstance(merged, NotMerged):
            raise UserError(_explain(merged, first, second))
        state, drawn = merged.state, OccupancyMap(records[0].resolution, records[0].threshold)
        drawn.update(state.poses, state.scans, state.drives)
        moved = move_record(records[1], merged.pose)
        record = MapRecord(
            robot=records[0].robot,
            resolution=records[0].resolution,
            threshold=records[0].threshold,
            edits=(*records[0].edits, *moved.edits),
            zones=join_zones(records[0].zones, moved.zones),
        )
        MapWriter(folder, record).write(drawn.grid(), state.poses, state.edges, state.scans)
        draw_masks(folder)
    found = {"name": name, "keyframes": len(state.poses), "links": merged.links, "place": list(merged.pose)}
    return {**found, "changes": merged.changes}


if __name__ == "__main__":
    sys.exit(main())
