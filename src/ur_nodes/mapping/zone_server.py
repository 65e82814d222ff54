"""Zones of the map that is served: published as masks and as polygons, and changed on request."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from functools import partial
from pathlib import Path

from ur.maps.record import ZoneKind
from ur_nodes.geometry.grid import Grid
from ur_nodes.mapping.changes import attempt, subscribe_changes
from ur_nodes.mapping.zone_file import Masks, ZoneFile, Zones, empty_mask
from ur_nodes.ports.node import Node, Publisher
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map

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
        self._node.work(partial(self._file.read, None), partial(self._take, renewed=True), "zones")

    def _look(self) -> None:
        if not self._busy:
            self._busy += 1
            self._node.work(partial(self._file.read, self._zones), self._take, "zones")

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
        self._take(zones, answered=True)

    def _take(self, zones: Zones, *, answered: bool = False, renewed: bool = False) -> None:
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
