"""Values over time as lines of text: each character is four dots high and two wide (Unicode's braille patterns).

Pure.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

# The bit of each dot of a braille character, by column and by row from the top.
_BITS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
_BLOCKS = " ▁▂▃▄▅▆▇█"
GAP = "×"  # noqa: RUF001 - a sign for the eye


def plot(values: Sequence[float | None], low: float, high: float, width: int, height: int) -> list[str]:
    """Return `height` lines of `width` characters: two values per character, the latest at the right.

    Values beyond `low` and `high` are drawn at the edge. If both values of a character are missing, the bottom line
    shows GAP; before the first value it is blank.
    """
    rows = 4 * height
    shown = list(values)[-2 * width :]
    blank = 2 * width - len(shown)
    cells = [[0] * width for _ in range(height)]
    for index, value in enumerate(shown, blank):
        if value is not None:
            part = (min(max(value, low), high) - low) / (high - low)
            row = (rows - 1) - round(part * (rows - 1))
            cells[row // 4][index // 2] |= _BITS[index % 2][row % 4]
    lines = [[chr(0x2800 + cell) if cell else " " for cell in line] for line in cells]
    for column in range(width):
        pair = [shown[index - blank] for index in (2 * column, 2 * column + 1) if index >= blank]
        if pair and all(value is None for value in pair):
            lines[-1][column] = GAP
    return ["".join(line) for line in lines]


def plot_bars(parts: Sequence[float | None], width: int) -> str:
    """Return one line of bars, 0..1, two values per character, of which the greater is drawn.

    Any value above 0 is visible.
    """
    shown = list(parts)[-2 * width :]
    if len(shown) % 2:
        shown.insert(0, None)
    pairs = [shown[index : index + 2] for index in range(0, len(shown), 2)]
    greatest = [max((part for part in pair if part is not None), default=0.0) for pair in pairs]
    return "".join(_BLOCKS[math.ceil(min(part, 1.0) * 8)] for part in greatest).rjust(width)


def log_scale(values: Sequence[float | None]) -> list[float | None]:
    """Return decadic logarithms, for a plot over several decades; values below a microsecond count as one."""
    return [None if value is None else math.log10(max(value, 1e-6)) for value in values]
