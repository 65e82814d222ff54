"""Pictures of maps as lines of text: half a terminal cell per pixel, or one character without colours."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ur.source.ansi import RESET
from ur.worlds.cells import OCCUPIED

_WALLS_FROM = 50
_UNKNOWN, _FREE, _WALL = 0, 1, 2
_COLOURS = (234, 239, 252)  # of the palette of 256
_LETTERS = " .#"


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
