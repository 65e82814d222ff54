"""Writes a map while it is made, consistent at every moment: the picture, the pose graph and the scans."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ur.maps.edit import apply_edits
from ur.maps.picture_file import write_picture
from ur.maps.record import RECORD, MapRecord, render_record
from ur.maps.scan_file import CHUNK, StoredGraph, StoredScan, encode_graph, encode_scans, read_graph, read_scans
from ur.source.diagnostic import UserError, error
from ur.source.replace import replace_file
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.map_state import Edge
from ur_nodes.slam.matching.scan import MapScan, restore_scan


def store_graph(poses: Sequence[Pose2], edges: Sequence[Edge]) -> StoredGraph:
    """A pose graph as it is stored."""
    return StoredGraph(
        np.array(poses, np.float64).reshape(-1, 3),
        np.array([(each.before, each.after) for each in edges], np.int32).reshape(-1, 2),
        np.array([each.relative for each in edges], np.float64).reshape(-1, 3),
        np.array([each.covariance for each in edges], np.float64).reshape(-1, 3, 3),
        np.array([each.robust for each in edges], np.bool_),
    )


def load_scans(folder: Path, record: MapRecord) -> list[MapScan]:
    """Read the scans of a map. Raises UserError: a file is missing or damaged."""
    scans: list[MapScan] = []
    for name in record.scans:
        stored = read_scans(folder / name)
        scans += [restore_scan(each.hits, each.numbers, each.misses, each.origin) for each in stored]
    return scans


def load_poses(folder: Path, record: MapRecord) -> tuple[list[Pose2], list[Edge], list[MapScan]]:
    """Read keyframes, edges and scans of a map.

    Raises UserError: the map has none, for example because it was imported, or a file is missing or damaged.
    """
    if not record.graph or not record.scans:
        message = f"map {folder.name!r} has a picture only, expected scans"
        raise UserError(error(message, rule="no-scans", help="navigate on it with map:=, or make a new map"))
    stored = read_graph(folder / record.graph)
    scans = load_scans(folder, record)
    if len(scans) < len(stored.poses):
        message = f"map {folder.name!r} has {len(scans)} scans, expected {len(stored.poses)}"
        raise UserError(error(message, rule="bad-map", help="copy the map again, or make a new one"))
    poses = [Pose2(*map(float, pose)) for pose in stored.poses]
    edges = [
        Edge(int(before), int(after), Pose2(*map(float, relative)), covariance, bool(robust))
        for (before, after), relative, covariance, robust in zip(
            stored.ends, stored.relative, stored.covariances, stored.robust, strict=True
        )
    ]
    return poses, edges, scans[: len(poses)]


_PICTURE = "map"


def pause_before_next(every: float, duration: float) -> float:
    """Return the time (s) from the end of a save to the next one, if `every` s of the map may be lost at most.

    A map that is killed just before a save ends has lost everything since the save before; hence `duration`, the time
    that a save takes (s), counts twice. A computer that is too slow for that still rests as long as it works.
    """
    return max(duration, every - 2.0 * duration)


class MapWriter:
    """Writes one map repeatedly into its folder, each time only the changes.

    The record is replaced last: until then it names the files of the last time, none of which is touched. Full chunks
    are written again only where a scan of them was replaced; the last one and the graph get a new name each time.
    """

    def __init__(self, folder: Path, record: MapRecord, put: Callable[..., None] = replace_file) -> None:
        """`put` replaces a file."""
        self._folder, self._replace = folder, put
        self._record = record
        names = (record.graph, *record.scans)
        self._number = max((int(name.split("_")[1].split(".")[0]) for name in names if name), default=0)
        full = list(record.scans[: record.keyframes // CHUNK])
        self._full: list[tuple[str, list[MapScan]]] = [(name, []) for name in full]  # none known: those of a run before
        for each in folder.glob("*.npz"):  # of a run that was killed
            if each.name not in names:
                each.unlink(missing_ok=True)

    @property
    def record(self) -> MapRecord:
        """The record as it was written last."""
        return self._record

    def write(self, grid: Grid, poses: Sequence[Pose2], edges: Sequence[Edge], scans: Sequence[MapScan]) -> None:
        """Write the map as it is now.

        Raises OSError; then the folder holds the map of the last time.
        """
        old = {self._record.graph, *self._record.scans}
        names = []
        for first in range(0, len(scans), CHUNK):
            part, number = list(scans[first : first + CHUNK]), first // CHUNK
            if number < len(self._full) and _same(self._full[number][1], part):
                names.append(self._full[number][0])
                continue
            name = self._new_name("scans")
            self._put(
                name, encode_scans([StoredScan(each.hits, each.numbers, each.misses, each.origin) for each in part])
            )
            names.append(name)
            if len(part) == CHUNK:
                self._full[number : number + 1] = [(name, part)]
        graph = self._new_name("graph")
        self._put(graph, encode_graph(store_graph(poses, edges)))
        now = time.time()
        record = replace(
            self._record,
            made=self._record.made or now,
            changed=now,
            keyframes=len(scans),
            resolution=grid.resolution,
            graph=graph,
            scans=tuple(names),
        )
        origin = (grid.origin.x, grid.origin.y, grid.origin.yaw)
        values = apply_edits(grid.values, grid.resolution, origin, record.edits)
        write_picture(self._folder / _PICTURE, values, grid.resolution, origin, put=self._replace)
        self._replace(self._folder / RECORD, render_record(record))
        self._record = record
        for name in old - {graph, *names} - {""}:
            (self._folder / name).unlink(missing_ok=True)

    def _new_name(self, kind: str) -> str:
        self._number += 1
        return f"{kind}_{self._number}.npz"

    def _put(self, name: str, content: bytes) -> None:
        self._replace(self._folder / name, content, parents=True)


def _same(stored: Sequence[MapScan], scans: Sequence[MapScan]) -> bool:
    return not stored or all(one is other for one, other in zip(stored, scans, strict=True))
