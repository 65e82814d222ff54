"""Writes occupancy grids as map files: an image and a YAML file beside it, as upstream's `map_saver` does."""

from __future__ import annotations

from pathlib import Path

from ur.maps.picture_file import write_picture
from ur_nodes.geometry.grid import Grid


def save_map(name: Path, grid: Grid, occupied: int = 65, free: int = 25) -> Path:
    """Write `name`.pgm and `name`.yaml as `ur.maps.picture_file.write_picture` does; returns the latter.

    Raises OSError. The defaults (per cent) are upstream's.
    """
    origin = (grid.origin.x, grid.origin.y, grid.origin.yaw)
    return write_picture(name, grid.values, grid.resolution, origin, occupied, free)
