"""Map files as occupancy grids."""

from __future__ import annotations

from pathlib import Path

from ur.worlds.map_file import read_map
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2


def load_map(path: str | Path) -> Grid:
    """Read a map's YAML file, or the floor plan of a world file, and its image. Raises UserError as `read_map`."""
    read = read_map(path)
    return Grid(read.values, read.file.resolution, Pose2(*read.file.origin))
