"""A picture and a status line as lines of text for a terminal: half-blocks, two pixels to a cell. Pure."""

import textwrap

from ur.source.ansi import RESET, REVERSE
from ur.tui.screen.half_blocks import draw_half_blocks
from ur_nodes.pictures.decode import Pixels
from ur_nodes.pictures.feed import FeedView

_STALE = 2.0  # s


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
    lines: list[str] = []
    if picture is not None:
        indent = " " * max(0, (columns - picture.shape[1]) // 2)
        lines = [indent + line for line in draw_half_blocks(picture, "rich" if rich else "palette")]
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
