"""Zones of the map that is served: read from its file, published as masks and as polygons, and changed on request."""

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np

from ur.maps.record import RECORD, Zone, ZoneKind, read_zone
from ur.maps.zone_mask import draw_mask
from ur.maps.zones import delete_zone, find_home, make_zone, put_zone
from ur.source.diagnostic import UserError
from ur.source.printable import printable
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.mapping.changes import attempt, subscribe_changes
from ur_nodes.ports.node import Node, Publisher
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map

Masks = Mapping[ZoneKind, Grid | None]
"""The mask of each kind; None: there is no such zone on the map."""

Stamp = tuple[int, ...]
"""Inode, time and size of a file, () where there is none. They change with its content."""

KINDS: tuple[ZoneKind, ...] = ("keep-out", "speed")


@dataclass(frozen=True, slots=True)
class Zones:
    """The zones of the file as of `stamp`, their masks, and `problem`: why they are those of before, or ''."""

    stamp: Stamp
    zones: tuple[Zone, ...]
    masks: Masks
    problem: str = ""


class ZoneFile:
    """The record of a map, `grid`, in which its zones are. Without state: for any thread."""

    def __init__(self, map_file: Path, grid: Grid) -> None:
        self._store, self._name = find_home(map_file, os.environ)
        self._grid = grid

    def read(self, before: Zones | None) -> Zones:
        """Read the zones; return `before` itself if the file is unchanged."""
        stamp = self._stamp()
        if before and stamp == before.stamp:
            return before
        known = before or Zones((), (), dict.fromkeys(KINDS))
        try:
            zones = self._store.record(self._name).zones
        except UserError as found:
            return Zones(stamp, known.zones, known.masks, printable(str(found))[:300])
        masks = known.masks if zones == known.zones else {kind: self._draw(zones, kind) for kind in KINDS}
        return Zones(stamp, zones, masks)

    def change(self, request: Mapping[str, object]) -> None:
        """Change the zones. After UserError, ValueError, TypeError or OSError they are unchanged."""
        if request.get("do") == "put":
            zone = read_zone(request.get("zone"))
            zone = make_zone(zone.name, zone.kind, zone.points, zone.percent)
            put_zone(self._store, self._name, zone, self._grid)
        elif request.get("do") == "delete":
            delete_zone(self._store, self._name, str(request.get("name", "")), self._grid)
        else:
            raise ValueError("do: expected put or delete")

    def _draw(self, zones: tuple[Zone, ...], kind: ZoneKind) -> Grid | None:
        mask = draw_mask(zones, kind, self._grid)
        return Grid(mask.values, mask.resolution, Pose2(*mask.origin, 0.0)) if mask else None

    def _stamp(self) -> Stamp:
        try:
            found = (self._store.path(self._name) / RECORD).stat()
        except OSError:
            return ()
        return found.st_ino, found.st_mtime_ns, found.st_size


def empty_mask(resolution: float) -> Grid:
    """Return the mask that replaces one whose last zone was deleted."""
    return Grid(np.zeros((1, 1), np.int8), resolution, Pose2(0.0, 0.0, 0.0))


_TOPICS: dict[ZoneKind, str] = {"keep-out": "keepout_filter_mask", "speed": "speed_filter_mask"}
_PERIOD = 1.0  # s between two looks at the file


class ZoneServer:
    """Publishes the zones of a map when they have changed, also where another program has changed them.

    `zones` (JSON) has them as polygons, and the answer to the last request on `zone_request`:
    {"id": text, "do": "put", "zone": {...}} or {"id": text, "do": "delete", "name": text}.
    A mask is published from the first zone of its kind on.
    """

    def __init__(self, node: Node, map_file: Path, grid: Grid, frame: str) -> None:
        self._node, self._frame, self._resolution = node, frame, grid.resolution
        self._file = ZoneFile(map_file, grid)
        self._answer: dict[str, str] | None = None
        self._masks: dict[ZoneKind, Publisher[Map]] = {}
        self._busy = 0  # jobs
        self._polygons = node.publish("zones", str, Quality.LATCHED)
        self._zones = self._file.read(None)
        self._publish()
        self._publish_masks(self._zones.masks)
        subscribe_changes(node, "zone_request", self._change)
        node.every(_PERIOD, self._look, steady=True)

    def use(self, map_file: Path, grid: Grid) -> None:
        """Publish the zones of another map from now on."""
        self._file, self._resolution = ZoneFile(map_file, grid), grid.resolution
        self._answer = None
        self._busy += 1
        self._node.work(partial(self._file.read, None), partial(self._on_zones, renewed=True), "zones")

    def _look(self) -> None:
        if not self._busy:
            self._busy += 1
            self._node.work(partial(self._file.read, self._zones), self._on_zones, "zones")

    def _change(self, request: Mapping[str, object]) -> None:
        before, file = self._zones, self._file

        def job() -> tuple[str, Zones]:
            _, problem = attempt(partial(file.change, request), "the zones")
            return problem, file.read(before)

        self._busy += 1
        self._node.work(job, partial(self._finish, str(request["id"])), "zones")

    def _finish(self, id: str, outcome: tuple[str, Zones]) -> None:
        problem, zones = outcome
        self._answer = {"id": id, "problem": problem}
        self._on_zones(zones, answered=True)

    def _on_zones(self, zones: Zones, *, answered: bool = False, renewed: bool = False) -> None:
        self._busy -= 1
        if zones is self._zones and not (answered or renewed):
            return
        changed = renewed or zones.zones != self._zones.zones
        self._zones = zones
        self._publish()
        if changed:
            self._publish_masks(zones.masks)

    def _publish(self) -> None:
        zones = self._zones
        if zones.problem:
            self._node.log.error(zones.problem)
        polygons = [asdict(zone) for zone in zones.zones]
        value = {"zones": polygons, "problem": zones.problem, "answer": self._answer}
        self._polygons.send(json.dumps(value, separators=(",", ":")))

    def _publish_masks(self, masks: Masks) -> None:
        for kind, mask in masks.items():
            if mask is None and kind not in self._masks:
                continue
            if kind not in self._masks:
                self._masks[kind] = self._node.publish(_TOPICS[kind], Map, Quality.LATCHED)
            self._masks[kind].send(Map(self._node.now(), self._frame, mask or empty_mask(self._resolution)))
