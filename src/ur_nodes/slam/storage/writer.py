"""Writes a map while it is made: the picture, the pose graph and the scans, consistent at every moment."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from ur.maps.edit import apply_edits
from ur.maps.picture_file import write_picture
from ur.maps.record import RECORD, MapRecord, render_record
from ur.maps.scan_file import CHUNK, encode_graph, encode_scans
from ur.source.replace import replace_file
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.pose_graph.edge import Edge
from ur_nodes.slam.storage.convert import store_graph, store_scan

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
            self._put(name, encode_scans([store_scan(each) for each in part]))
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
