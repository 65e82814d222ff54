"""Pictures of maps as lines of text: half a terminal cell per pixel, or one character without colours."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ur.maps.viewport import Viewport
from ur.source.ansi import RESET
from ur.worlds.cells import OCCUPIED, UNKNOWN, look_up
from ur.worlds.map_file import MapImage

_WALLS_FROM = 50
_UNKNOWN, _FREE, _WALL = 0, 1, 2
FREE_PIXEL, WALL_PIXEL = _FREE, _WALL
"""Values of pixels; others are unknown."""
_COLOURS = (234, 239, 252)  # of the palette of 256
_LETTERS = " .#"
_MOST_SAMPLES = 8  # a side, of a pixel


def sample_pixels(image: MapImage, view: Viewport) -> NDArray[np.uint8]:
    """Return the pixels (view.height, view.width) of a map. A pixel with a wall anywhere in it shows a wall."""
    finer = min(_MOST_SAMPLES, max(1, math.ceil(view.scale / image.resolution)))
    at = (np.arange(finer) + 0.5) / finer
    columns = (np.arange(view.width)[:, None] + at).ravel()
    rows = (np.arange(view.height)[:, None] + at).ravel()
    x, y = view.to_map(columns, rows)  # type: ignore[arg-type]  # arrays as well
    points = np.stack(np.meshgrid(x, y), axis=-1)
    found = np.asarray(look_up(image, image.values, points, UNKNOWN))
    blocks = found.reshape(view.height, finer, view.width, finer)
    walls = ((blocks >= _WALLS_FROM) & (blocks <= OCCUPIED)).any(axis=(1, 3))
    free = ((blocks >= 0) & (blocks < _WALLS_FROM)).mean(axis=(1, 3)) >= 0.5
    pixels: NDArray[np.uint8] = np.where(walls, _WALL, np.where(free, _FREE, _UNKNOWN)).astype(np.uint8)
    return pixels


def draw_lines(values: NDArray[np.int8], columns: int, rows: int, *, colour: bool) -> list[str]:
    """Draw cells (height, width), row 0 at the bottom, as at most `rows` lines of at most `columns` characters.

    The unknown margin of the map is cut off. A pixel with any wall in it shows a wall.
    """
    seen = values >= 0
    if not seen.any() or columns < 1 or rows < 1:
        return []
    height_at, width_at = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    part = values[height_at[0] : height_at[-1] + 1, width_at[0] : width_at[-1] + 1][::-1]
    height, width = part.shape
    side = max(1, math.ceil(max(width / columns, height / (2 * rows))))
    high, wide = math.ceil(height / side), math.ceil(width / side)
    padded = np.full((2 * math.ceil(high / 2) * side, wide * side), -1, np.int8)
    padded[:height, :width] = part
    blocks = padded.reshape(-1, side, wide, side)
    walls = ((blocks >= _WALLS_FROM) & (blocks <= OCCUPIED)).any(axis=(1, 3))
    free = (blocks >= 0).mean(axis=(1, 3)) >= 0.5
    pixels = np.where(walls, _WALL, np.where(free, _FREE, _UNKNOWN))
    pairs = pixels.reshape(-1, 2, wide)
    if not colour:
        return ["".join(_LETTERS[each] for each in pair.max(axis=0).tolist()).rstrip() for pair in pairs]
    return [_coloured(upper.tolist(), lower.tolist()) for upper, lower in pairs]


def _coloured(upper: list[int], lower: list[int]) -> str:
    text, before = "", (-1, -1)
    for pair in zip(upper, lower, strict=True):
        if pair != before:
            text += f"\033[38;5;{_COLOURS[pair[0]]};48;5;{_COLOURS[pair[1]]}m"
            before = pair
        text += "▀"
    return text + RESET
