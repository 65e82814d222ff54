"""The floor plan of a world: the walls of a map."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ur.source.section import Section
from ur.worlds.map_file import MapImage, read_map, read_map_section


@dataclass(frozen=True, slots=True)
class FloorPlan:
    """Cells of `resolution` m: `occupied[row, column]`, row 0 at the bottom.

    `origin` (x, y, yaw in the map frame: m, rad) is the outer corner of cell (0, 0).
    """

    occupied: npt.NDArray[np.bool_]
    resolution: float
    origin: tuple[float, float, float]

    def contains(self, x: float, y: float) -> bool:
        """Return whether a point of the map frame (m) lies within the image."""
        column, row = self._cell(x, y)
        rows, columns = self.occupied.shape
        return bool(0 <= row < rows and 0 <= column < columns)

    def is_occupied(self, x: float, y: float) -> bool:
        """Return whether a point of the map frame (m) lies in an occupied cell."""
        column, row = self._cell(x, y)
        return self.contains(x, y) and bool(self.occupied[row, column])

    def _cell(self, x: float, y: float) -> tuple[int, int]:
        ox, oy, yaw = self.origin
        c, s = math.cos(yaw), math.sin(yaw)
        dx, dy = x - ox, y - oy
        return math.floor((c * dx + s * dy) / self.resolution), math.floor((c * dy - s * dx) / self.resolution)


def read_floor_plan(path: str | Path) -> FloorPlan:
    """Read a map_server YAML file and its image. Raises UserError that names the file, line, key or image."""
    return _floor_plan(read_map(path))


def parse_floor_plan(top: Section, folder: Path) -> FloorPlan:
    """Read the keys of a floor plan from a file that may hold others, and the image that it names below `folder`.

    Raises UserError that names the file, line, key or image.
    """
    return _floor_plan(read_map_section(top, folder))


def _floor_plan(read: MapImage) -> FloorPlan:
    return FloorPlan(read.walls, read.file.resolution, read.file.origin)
