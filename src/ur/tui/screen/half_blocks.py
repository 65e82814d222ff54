"""Pictures on a terminal: two pixels to a cell, an upper half block in the colours of both. Pure."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ur.source.ansi import RESET

Colour = tuple[int, int, int]
"""Red, green, blue, 0 to 255."""

Pixels = NDArray[np.uint8]
"""(rows, columns, 3), red, green, blue."""

Run = tuple[str, Colour, Colour]
"""Text, its colour, the colour behind it."""

Depth = Literal["rich", "palette", "letters"]
"""Colours of 24 bits, the palette of 256, or none: then walls are `#`."""

_LEVELS = np.array([0, 95, 135, 175, 215, 255], np.uint8)  # of the cube of 6 x 6 x 6 colours in the palette
_EDGES = [48, 115, 155, 195, 235]
_GREY = 8  # between the brightest and the darkest part
_WALL, _FREE = 120, 30  # brightness from which a pixel is a wall, or floor, without colours


@dataclass(frozen=True, slots=True)
class Glyph:
    """A character over the pixels of one terminal cell."""

    column: int
    row: int
    text: str
    colour: Colour
    behind: Colour | None = None  # None: what the pixels show


def draw_half_blocks(picture: Pixels, depth: Depth, glyphs: Iterable[Glyph] = ()) -> list[str]:
    """Return the lines of a picture; one of an odd height gets a dark row below."""
    if picture.shape[0] % 2:
        picture = np.concatenate([picture, np.zeros_like(picture[:1])])
    if depth == "palette":  # few colours are written fast
        grey = np.ptp(picture, axis=-1, keepdims=True) < _GREY
        picture = np.where(grey, picture, _LEVELS[np.digitize(picture, _EDGES)])
    write = {"rich": _write_rich, "palette": _write_palette, "letters": _write_letters}[depth]
    end = "" if depth == "letters" else RESET
    return ["".join(map(write, line)) + end for line in cells_of_pixels(picture, glyphs)]


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


def _write_rich(run: Run) -> str:
    text, fore, back = run
    return f"\x1b[38;2;{fore[0]};{fore[1]};{fore[2]};48;2;{back[0]};{back[1]};{back[2]}m{text}"


def _write_palette(run: Run) -> str:
    text, fore, back = run
    return f"\x1b[38;5;{_code(fore)};48;5;{_code(back)}m{text}"


def _write_letters(run: Run) -> str:
    text, fore, back = run
    if text.strip("▀ ") or (text == " " and fore != back):
        return text
    brightest = max(max(fore), max(back))
    return ("#" if brightest >= _WALL else "." if brightest >= _FREE else " ") * len(text)


@lru_cache(maxsize=4096)
def _code(colour: Colour) -> int:
    """Return the index of the nearest of 256 colours: a grey, or one of the cube of 6 x 6 x 6."""
    if max(colour) - min(colour) < _GREY:
        grey = round((sum(colour) / 3 - 8) / 10)
        return 16 if grey < 0 else 231 if grey > 23 else 232 + grey
    red, green, blue = (0 if part < 48 else 1 if part < 115 else (part - 35) // 40 for part in colour)
    return 16 + 36 * red + 6 * green + blue
