"""Writes occupancy grids as map files: an image and a YAML file beside it, as upstream's `map_saver` does."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ur.source.replace import replace_file
from ur_nodes.geometry.grid import OCCUPIED, Grid

_DARK, _GREY, _LIGHT = 0, 205, 254  # upstream's: occupied, unknown, free
_OCCUPIED_FROM, _FREE_BELOW = 65, 25  # per cent, upstream's
_THRESHOLDS = (0.65, 0.196)  # of the file; the unknown grey lies between them


def save_map(name: Path, grid: Grid, occupied: int = _OCCUPIED_FROM, free: int = _FREE_BELOW) -> Path:
    """Write `name`.pgm and `name`.yaml; returns the latter. Raises OSError.

    Cells from `occupied` (0..100) on are walls, those up to `free` are floor, others are unknown.
    """
    values = grid.values
    pixels = np.full(values.shape, _GREY, np.uint8)
    pixels[(values >= 0) & (values <= free)] = _LIGHT
    pixels[(values >= occupied) & (values <= OCCUPIED)] = _DARK
    image, file = name.with_name(f"{name.name}.pgm"), name.with_name(f"{name.name}.yaml")
    header = f"P5\n# {grid.resolution:g} m per pixel\n{grid.width} {grid.height}\n255\n"
    replace_file(image, header.encode() + pixels[::-1].tobytes())
    replace_file(file, describe_map(image.name, grid))
    return file


def describe_map(image: str, grid: Grid) -> str:
    """The text of a map's YAML file; `image` is relative to it."""
    origin = ", ".join(f"{value:.6g}" for value in grid.origin)
    quoted = "'" + image.replace("'", "''") + "'"
    return (
        f"image: {quoted}\nresolution: {grid.resolution:g}\norigin: [{origin}]\nnegate: 0\n"
        f"occupied_thresh: {_THRESHOLDS[0]}\nfree_thresh: {_THRESHOLDS[1]}\n"
    )
