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

    Cells from `occupied` (0..100) on are walls, those up to `free` are floor, others are unknown. Folders that are
    missing are made. At every moment the YAML file is whole and names an image that belongs to it: where it names
    `name`.pgm already, the new image is `name`_2.pgm, and the old one is removed at the end.
    """
    values = grid.values
    pixels = np.full(values.shape, _GREY, np.uint8)
    pixels[(values >= 0) & (values <= free)] = _LIGHT
    pixels[(values >= occupied) & (values <= OCCUPIED)] = _DARK
    file = name.with_name(f"{name.name}.yaml")
    images = [name.with_name(f"{name.name}{suffix}.pgm") for suffix in ("", "_2")]
    image, other = images[::-1] if _names(file, images[0].name) else images
    header = f"P5\n# {grid.resolution:g} m per pixel\n{grid.width} {grid.height}\n255\n"
    replace_file(image, header.encode() + pixels[::-1].tobytes(), parents=True)
    replace_file(file, describe_map(image.name, grid))
    other.unlink(missing_ok=True)
    return file


def describe_map(image: str, grid: Grid) -> str:
    """The text of a map's YAML file; `image` is relative to it."""
    origin = ", ".join(f"{value:.6g}" for value in grid.origin)
    return (
        f"{_image_line(image)}\nresolution: {grid.resolution:g}\norigin: [{origin}]\nnegate: 0\n"
        f"occupied_thresh: {_THRESHOLDS[0]}\nfree_thresh: {_THRESHOLDS[1]}\n"
    )


def _image_line(image: str) -> str:
    return "image: '" + image.replace("'", "''") + "'"


def _names(file: Path, image: str) -> bool:
    """Test a map's YAML file, of ours or of upstream's, for the name of an image."""
    try:
        lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    except FileNotFoundError:
        return False
    return _image_line(image) in lines or f"image: {image}" in lines
