"""Occupancy grids: maps as map servers publish them and as localisation and navigation use them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ur.worlds.cells import FREE, OCCUPIED, UNKNOWN, CellFrame, look_up
from ur_nodes.geometry.pose import Pose2

__all__ = ["FREE", "OCCUPIED", "UNKNOWN", "CellFrame", "Grid", "load_map", "look_up"]


@dataclass(frozen=True, slots=True, eq=False)
class Grid(CellFrame):
    """Occupancy per square cell of the plane.

    `values` is int8 (height, width): -1 unknown, 0 free to 100 occupied; the array is not to be written to.
    `resolution` is the side of a cell in m; `origin` is a pose in the frame of the map (REP 103).
    """

    values: NDArray[np.int8]
    resolution: float
    origin: Pose2

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of rows and columns."""
        height, width = self.values.shape
        return height, width

    def values_at(self, points: NDArray[np.floating], outside: int = UNKNOWN) -> NDArray[np.int8]:
        """The values (...) below points (..., 2) in m; `outside` where the grid does not reach."""
        return look_up(self, self.values, points, outside)


def load_map(path: str | Path) -> Grid:
    """Read a map's YAML file, or the floor plan of a world file, and its image. Raises UserError as `read_map`."""
    from ur.worlds.map_file import read_map  # few nodes read files

    read = read_map(path)
    return Grid(read.values, read.resolution, Pose2(*read.origin))
