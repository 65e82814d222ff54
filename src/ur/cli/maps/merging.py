"""`ur maps merge`: merge two stored maps into a third one, by a process of the mapping node's package."""

import os
import subprocess
import sys
from dataclasses import dataclass

from ur.maps.change import move_places
from ur.maps.names import check_map_name, read_places, waypoint_path, write_places
from ur.maps.store import MapStore
from ur.request.requirements.python_packages import need_all
from ur.source.diagnostic import user_error
from ur.source.foreign.json_values import read_json
from ur.source.progress_line import show_progress
from ur.system.child_processes import end_with_us

_SECONDS = 1800.0
_SHOWN = 10  # places where the maps differ, at most


def merge_maps(store: MapStore, first: str, second: str, name: str) -> str:
    """Merge two maps of the user's store into a third one, with the waypoints of both; return its description.

    Raises UserError or OSError, without a new map. If `MergeFailed` is raised, the process has already printed its
    diagnostics to standard error.
    """
    first, second = store.resolve(first), store.resolve(second)
    check_map_name(name)
    if first == second:
        raise user_error(
            f"cannot merge {first!r} with itself", rule="same-map", help="ur maps lists the maps", subject=first
        )
    need_all(["gtsam"], "vision.lock", "OpenCV and gtsam (100 MB to download)")
    command = [*end_with_us("KILL"), sys.executable, "-I", "-m", "ur_nodes", "ur_nodes.slam.storage.merging"]
    with show_progress(f"looking for {second} on {first}"):
        done = subprocess.run([*command, first, second, name], capture_output=True, text=True, timeout=_SECONDS)
    sys.stderr.write(done.stderr)
    if done.returncode:
        raise MergeFailed(done.returncode)
    merged = read_json(done.stdout, MergedMap)
    mine, other = (read_places(waypoint_path(each, os.environ)) for each in (first, second))
    places = {**move_places(other, merged.place), **mine}
    if places:
        write_places(waypoint_path(name, os.environ), places)
    twice = ", ".join(sorted(set(mine) & set(other)))
    kept = f"; waypoints of both names are those of {first}: {twice}" if twice else ""
    shown = [f"\n  {width:.1f} x {height:.1f} m at ({x:.1f}, {y:.1f})" for x, y, width, height in merged.changes]
    differ = f"\nThe maps differ in {len(shown)} places, drawn as in {second}:" if shown else ""
    statistics = f"{merged.keyframes} scans, {merged.links} links between the two maps"
    return "".join((f"{name}: {statistics}{kept}{differ}", *shown[:_SHOWN]))


@dataclass(frozen=True, slots=True)
class MergedMap:
    """The output of `ur_nodes.slam.storage.merging`: the second map's pose in the first, and rectangles that differ."""

    place: tuple[float, float, float]
    keyframes: int
    links: int
    changes: tuple[tuple[float, float, float, float], ...] = ()


class MergeFailed(Exception):  # noqa: N818 - an outcome
    """The maps were not merged; the first argument is the exit code."""
