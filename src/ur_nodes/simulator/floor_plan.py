"""A floor plan: an image and a YAML file in map_server's format, read into a grid of occupied cells."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from ur.source.diagnostic import UserError, error
from ur.source.section import Section, read_section

_MODES = ("trinary", "scale", "raw")


@dataclass(frozen=True, slots=True)
class FloorPlan:
    """Cells of `resolution` m: `occupied[row, column]`, row 0 at the bottom.

    `origin` (x, y, yaw in the map frame: m, rad) is the outer corner of cell (0, 0).
    """

    occupied: npt.NDArray[np.bool_]
    resolution: float
    origin: tuple[float, float, float]

    def contains(self, x: float, y: float) -> bool:
        """Whether a point of the map frame (m) lies within the image."""
        column, row = self._cell(x, y)
        rows, columns = self.occupied.shape
        return bool(0 <= row < rows and 0 <= column < columns)

    def is_occupied(self, x: float, y: float) -> bool:
        """Whether a point of the map frame (m) lies in an occupied cell."""
        column, row = self._cell(x, y)
        return self.contains(x, y) and bool(self.occupied[row, column])

    def _cell(self, x: float, y: float) -> tuple[int, int]:
        ox, oy, yaw = self.origin
        c, s = math.cos(yaw), math.sin(yaw)
        dx, dy = x - ox, y - oy
        return math.floor((c * dx + s * dy) / self.resolution), math.floor((c * dy - s * dx) / self.resolution)


def read_floor_plan(path: str | Path) -> FloorPlan:
    """Read a map_server YAML file and its image. Raises UserError that names the file, line, key or image."""
    top = read_section(path, "a floor plan in map_server's format")
    image = Path(path).parent / top.text("image")
    resolution = top.number("resolution", minimum=0.001, maximum=10.0)
    x, y, yaw = top.numbers("origin", 3)
    negate = top.boolean("negate", False)
    threshold = top.number("occupied_thresh", minimum=0.0, maximum=1.0)
    top.number("free_thresh", minimum=0.0, maximum=1.0)
    mode = top.text("mode", "trinary", choices=_MODES)
    top.finish()
    levels = _read_levels(top, image, mode)
    if mode == "raw":  # the levels are occupancy values themselves: 0 to 100, others unknown
        occupied = (levels <= 100.0) & (levels / 100.0 > threshold)
    else:
        occupied = (levels if negate else 255.0 - levels) / 255.0 > threshold
    return FloorPlan(np.ascontiguousarray(occupied[::-1]), resolution, (x, y, yaw))


def _read_levels(top: Section, path: Path, mode: str) -> npt.NDArray[np.float64]:
    """Brightness 0 to 255 of each pixel, the mean of its channels as map_server takes it (alpha counts if trinary)."""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            wide = image.mode.startswith("I")
            pixels = np.asarray(image if image.mode in ("L", "LA", "RGB", "RGBA") or wide else image.convert("RGB"))
    except FileNotFoundError:
        _fail(top, f"image {path} does not exist, expected the picture of the floor plan")
    except (UnidentifiedImageError, OSError, SyntaxError, ValueError) as problem:  # what Pillow raises on broken files
        reason = "not a picture it can read" if isinstance(problem, UnidentifiedImageError) else str(problem)
        _fail(top, f"image {path} is damaged ({reason}), expected PNG, PGM or another common format")
    levels: npt.NDArray[np.float64] = pixels.astype(np.float64) / (257.0 if wide else 1.0)
    if levels.ndim == 3:
        channels = levels.shape[2]
        counted = channels - 1 if channels in (2, 4) and mode != "trinary" else channels
        levels = levels[..., :counted].mean(axis=2)
    return levels


def _fail(top: Section, message: str) -> NoReturn:
    raise UserError(error(message, top.span_of("image"), rule="bad-image"))
