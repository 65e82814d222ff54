"""Pixels as terminal cells: two pixels to a cell, in runs of the same colours."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ur_nodes.teleop.map_view.glyphs import Glyph
from ur_nodes.teleop.map_view.palette import Colour
from ur_nodes.teleop.map_view.picture import Pixels

Run = tuple[str, Colour, Colour]
"""Text, its colour, the colour behind it."""


def cells_of_pixels(picture: Pixels, glyphs: Iterable[Glyph] = ()) -> list[tuple[Run, ...]]:
    """Convert a picture (2 * rows, columns, 3) to rows of runs. A glyph's background is its cell's mean colour."""
    rows, columns = picture.shape[0] // 2, picture.shape[1]
    if not rows or not columns:
        return []
    upper, lower = picture[0 : rows * 2 : 2], picture[1 : rows * 2 : 2]
    packed = _pack(upper) << np.uint64(24) | _pack(lower)
    over: dict[int, dict[int, Glyph]] = {}
    for glyph in glyphs:
        over.setdefault(glyph.row, {})[glyph.column] = glyph
    lines = []
    for row in range(rows):
        line = packed[row]
        breaks = np.flatnonzero(line[1:] != line[:-1]) + 1
        marks = over.get(row)
        if marks:
            edges = {e for column in marks for e in (column, column + 1)}
            breaks = np.array(sorted({*breaks.tolist(), *edges} - {0, columns}), dtype=np.intp)
        starts = [0, *breaks.tolist()]
        ends = [*breaks.tolist(), columns]
        values = line[starts].tolist()
        lines.append(
            tuple(
                _run(value, end - start, marks.get(start) if marks else None)
                for start, end, value in zip(starts, ends, values, strict=True)
            )
        )
    return lines


def _pack(pixels: Pixels) -> NDArray[np.uint64]:
    wide: NDArray[np.uint64] = pixels.astype(np.uint64)
    packed: NDArray[np.uint64] = wide[..., 0] << np.uint64(16) | wide[..., 1] << np.uint64(8) | wide[..., 2]
    return packed


def _run(value: int, length: int, glyph: Glyph | None) -> Run:
    upper, lower = _unpack(value >> 24), _unpack(value & 0xFFFFFF)
    if glyph is not None:
        behind = glyph.behind or ((upper[0] + lower[0]) // 2, (upper[1] + lower[1]) // 2, (upper[2] + lower[2]) // 2)
        return glyph.text, glyph.colour, behind
    if upper == lower:
        return " " * length, upper, lower
    return "▀" * length, upper, lower


def _unpack(value: int) -> Colour:
    return value >> 16 & 255, value >> 8 & 255, value & 255
