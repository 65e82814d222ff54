"""List of stored maps for a terminal: a small picture of each, and its size, age, robot and contents."""

from __future__ import annotations

import time

from ur.maps.store import MapStore
from ur.source.ansi import BOLD, RESET, strip_styles
from ur.source.diagnostic import UserError
from ur.source.printable import printable

_PICTURE = (30, 6)  # columns and lines of the picture of a map in a list
_NARROW = 70  # columns: without pictures


def describe_map(store: MapStore, name: str) -> str:
    """The size of a map, when it was changed, which robot has made it, and what it can be used for."""
    from ur.worlds.map_file import read_map

    try:
        image, record = read_map(store.picture(name)), store.record(name)
    except UserError as problem:
        return f"damaged: {problem.diagnostics[0].message}"
    parts = [f"{image.width * image.resolution:.1f} x {image.height * image.resolution:.1f} m"]
    if record.changed:
        parts.append(time.strftime("%Y-%m-%d %H:%M", time.localtime(record.changed)))
    if record.robot:
        parts.append(printable(record.robot))
    parts.append(f"{record.keyframes} scans" if record.graph else "picture only")
    if store.latest() == name:
        parts.append("the last one of this robot")
    return ", ".join(parts)


def list_maps(store: MapStore, columns: int, *, colour: bool) -> list[str]:
    """Lines for a terminal: the picture of each map, and its facts beside it."""
    from ur.maps.drawing import draw_lines
    from ur.worlds.map_file import read_map

    lines: list[str] = []
    for name in store.names():
        text = [f"{BOLD}{name}{RESET}" if colour else name, *describe_map(store, name).split(", ")]
        try:
            picture = draw_lines(read_map(store.picture(name)).values, *_PICTURE, colour=colour)
        except UserError:
            picture = []
        if columns < _NARROW:
            picture = []
        width = _PICTURE[0] + 2 if columns >= _NARROW else 0
        for row in range(max(len(picture), len(text))):
            left = picture[row] if row < len(picture) else ""
            right = text[row] if row < len(text) else ""
            lines.append((left + " " * (width - len(strip_styles(left))) + right).rstrip())
        lines.append("")
    return lines[:-1]
