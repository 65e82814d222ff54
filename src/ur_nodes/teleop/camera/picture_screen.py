"""A picture and a status line as lines of text for a terminal: half-blocks, two pixels to a cell. Pure."""

from __future__ import annotations

import textwrap

import numpy as np
from numpy.typing import NDArray

from ur.source.ansi import RESET, REVERSE
from ur_nodes.pictures.decode import Pixels
from ur_nodes.pictures.feed import FeedView

_STALE = 2.0  # s
_LEVELS = np.array([0, 95, 135, 175, 215, 255])  # of the 6 x 6 x 6 cube that terminals of 256 colours have


def describe_silence(view: FeedView) -> str:
    """Describe for how long no picture has arrived, and the reason if it is known; empty while pictures arrive."""
    if not view.silent:
        return ""
    return f"no picture on {view.topic} for {view.silence:.0f} s" + (f": {view.reason}" if view.reason else "")


def describe_feed(view: FeedView) -> str:
    """Describe topic, size and rate of the pictures in one line."""
    if view.picture is None:
        return f"{view.topic}: waiting for {'the first picture' if view.publishers else 'a publisher'}"
    if view.silence > _STALE:
        return f"{view.topic}: no picture for {view.silence:.0f} s"
    size = f"{view.size[0]} x {view.size[1]}"
    return f"{view.topic}   {size}   {view.rate:.1f} pictures a second   {view.length / 1000:.0f} kB each"


def draw_picture_screen(
    picture: Pixels | None,
    status: str,
    columns: int,
    rows: int,
    *,
    rich: bool,
    notice: str = "",
    advice: tuple[str, str] | None = None,
) -> list[str]:
    """`rows` lines of `columns` cells: the picture in the middle, the status below it.

    The picture is at most `columns` wide and 2 * (rows - 1) high; with `advice`, a line above the status and what is at
    its right end, 2 * (rows - 2). `rich`: the terminal knows 24-bit colours. `notice`
    is text that is wrapped and shown in the middle, in place of the picture's lines there.
    """
    first = [advice] if advice and rows > 2 else []
    bars = [_draw_bar(*each, columns) for each in (*first, (status, "q quits"))]
    room = rows - len(bars)
    lines = [] if picture is None else _draw_cells(picture, columns, rich=rich)
    body = _centre(lines, room)
    if notice:
        width = max(1, columns - 4)
        words = ["", *(f"  {line}" for line in textwrap.wrap(notice, width)), ""][:room]
        above = (room - len(words)) // 2
        body[above : above + len(words)] = words
    return [*body, *bars]


def _draw_bar(text: str, end: str, columns: int) -> str:
    right = f"{end} " if end else ""
    left = f" {text}"[: max(0, columns - len(right) - 1)]
    return f"{REVERSE}{left}{' ' * max(0, columns - len(left) - len(right))}{right[:columns]}{RESET}"


def _centre(lines: list[str], room: int) -> list[str]:
    above = max(0, (room - len(lines)) // 2)
    return ([""] * above + lines + [""] * room)[:room]


def _draw_cells(picture: Pixels, columns: int, *, rich: bool) -> list[str]:
    if picture.shape[0] % 2:
        picture = np.concatenate([picture, np.zeros_like(picture[:1])])
    indent = " " * max(0, (columns - picture.shape[1]) // 2)
    codes = _pack(picture) if rich else _palette(picture)
    write = _write_rich if rich else _write_plain
    lines = []
    for upper, lower in zip(codes[0::2].tolist(), codes[1::2].tolist(), strict=True):
        parts, front, back = [indent], -1, -1
        for top, bottom in zip(upper, lower, strict=True):
            if top != front:
                parts.append(write(38, top))
                front = top
            if bottom != back:
                parts.append(write(48, bottom))
                back = bottom
            parts.append("▀")
        lines.append("".join([*parts, RESET]))
    return lines


def _pack(picture: Pixels) -> NDArray[np.int64]:
    wide: NDArray[np.int64] = picture.astype(np.int64)
    packed: NDArray[np.int64] = wide[..., 0] << 16 | wide[..., 1] << 8 | wide[..., 2]
    return packed


def _palette(picture: Pixels) -> NDArray[np.int64]:
    # The nearest level of the cube for each of red, green and blue (xterm's 256 colours: 16 + 36 r + 6 g + b).
    levels = np.abs(picture[..., None].astype(np.int64) - _LEVELS).argmin(axis=-1)
    codes: NDArray[np.int64] = 16 + 36 * levels[..., 0] + 6 * levels[..., 1] + levels[..., 2]
    return codes


def _write_rich(kind: int, colour: int) -> str:
    return f"\x1b[{kind};2;{colour >> 16};{colour >> 8 & 255};{colour & 255}m"


def _write_plain(kind: int, colour: int) -> str:
    return f"\x1b[{kind};5;{colour}m"
