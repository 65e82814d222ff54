"""The file of a map's named places: one store and one rule for names, for terminal, page and `ur maps`."""

import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path

from ur.source.replace import replace_file
from ur.source.section import read_section
from ur.source.user_folders import user_folder

Place = tuple[float, float, float]
"""x, y in m, and degrees, in the frame of the map."""

_HEAD = "# Waypoints of the map {name}: name: [x, y, angle], in m, m and degrees, in the map frame.\n"


def waypoint_path(name: str, environment: Mapping[str, str]) -> Path:
    """Return the waypoint file of a map: below XDG_DATA_HOME, which is ~/.local/share unless set.

    `name` may be the path of a map; then its stem counts.
    """
    stem = re.sub(r"[^A-Za-z0-9_.-]", "_", Path(name).stem if "/" in name else name)
    return Path(user_folder("XDG_DATA_HOME", environment), "ubiquity_launches", "waypoints", f"{stem}.yaml")


def read_places(path: Path) -> dict[str, Place]:
    """Read the waypoints of a map, sorted by name; empty without a file. Raises UserError, with the line."""
    if not path.exists():
        return {}
    section = read_section(path, "a waypoint file")
    found: dict[str, Place] = {}
    for name in sorted(section.keys):
        x, y, degrees = section.numbers(name, 3)
        found[name] = (x, y, degrees)
    return found


def write_places(path: Path, places: Mapping[str, Place], sync: Callable[[int], object] = os.fsync) -> None:
    """Replace the waypoints of a map. Raises OSError."""
    lines = [
        f"{_key(name)}: [{_number(x, 3)}, {_number(y, 3)}, {_number(degrees, 1)}]\n"
        for name, (x, y, degrees) in sorted(places.items())
    ]
    text = _HEAD.format(name=path.stem) + "".join(lines or ["{}\n"])
    replace_file(path, text, parents=True, sync=sync)


def _key(name: str) -> str:
    return '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'  # 007 and yes are names, not values


def _number(value: float, digits: int) -> str:
    return f"{round(value, digits) + 0.0:.{digits}f}"  # 0.0: never -0.000
