"""List of stored maps for a terminal or a script: a small picture of each, its size, age, robot and content."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING

from ur.maps.record import MapRecord
from ur.maps.store import MapStore
from ur.maps.waypoint_file import read_places, waypoint_path
from ur.source.ansi import BOLD, RESET, strip_styles
from ur.source.diagnostic import UserError
from ur.source.printable import printable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_PICTURE = (30, 6)  # columns and lines of the picture of a map in a list
_SCRIPT_PICTURE = (64, 32)  # the same for a script
_WALLS_FROM = 50
_UNKNOWN, _FREE, _WALL = 0, 1, 2
_COLOURS = ((28, 28, 28), (78, 78, 78), (208, 208, 208))
_NARROW = 70  # columns: without pictures


def describe_map(store: MapStore, name: str) -> str:
    """Describe a map: its size, time of change, the robot that made it, and its uses."""
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
    """Return lines for a terminal: the picture of each map, and its properties beside it."""
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


def list_facts(store: MapStore, name: str, environment: Mapping[str, str], *, picture: bool) -> dict[str, object]:
    """Return the properties of a map for a script.

    `width` and `height` are in m, `places` is the number of places, and `problem` is set if the map is damaged.
    `picture` is a list of lines from `draw_lines` without colours.
    """
    from ur.worlds.map_file import read_map

    record, image, places, problem = MapRecord(), None, 0, ""
    try:
        record, image = store.record(name), read_map(store.picture(name))
        places = len(read_places(waypoint_path(name, environment)))
    except UserError as found:
        problem = printable(found.diagnostics[0].message)
    facts: dict[str, object] = {
        "name": name,
        "robot": record.robot,
        "made": record.made,
        "changed": record.changed,
        "keyframes": record.keyframes,
        "width": None if image is None else round(image.width * image.resolution, 2),
        "height": None if image is None else round(image.height * image.resolution, 2),
        "places": places,
        "file": str(store.picture(name)),
        "latest": store.latest() == name,
        "problem": problem,
    }
    if picture:
        facts["picture"] = [] if image is None else draw_lines(image.values, *_SCRIPT_PICTURE, colour=False)
    return facts


def draw_lines(values: NDArray[np.int8], columns: int, rows: int, *, colour: bool) -> list[str]:
    """Draw cells (height, width), row 0 at the bottom, as at most `rows` lines of at most `columns` characters.

    The unknown margin of the map is cut off. A pixel with any wall in it shows a wall.
    """
    import numpy as np

    from ur.tui.screen.half_blocks import draw_half_blocks
    from ur.worlds.cells import OCCUPIED

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
    lines = draw_half_blocks(np.array(_COLOURS, np.uint8)[pixels], "palette" if colour else "letters")
    return lines if colour else [line.rstrip() for line in lines]
