"""Zones of a map in its file: read when they have changed, and changed on request."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ur.maps.record import RECORD, Zone, ZoneKind, read_zone
from ur.maps.zone_mask import draw_mask
from ur.maps.zones import delete_zone, find_home, make_zone, put_zone
from ur.source.diagnostic import UserError
from ur.source.printable import printable
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

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
