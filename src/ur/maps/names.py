"""Names of stored maps, which are safe in a shell, a launch file and a file system, and of what is on them."""

import os
import re
from collections.abc import Callable, Collection, Mapping
from pathlib import Path

from ur.source.diagnostic import user_error
from ur.source.printable import printable
from ur.source.replace import replace_file
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
    from ur.source.section import read_section  # reads YAML, which a launch that checks a name does without

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


LATEST = "latest"
"""Stands for the last map that was made with the robot of this computer."""

LONGEST = 64
PLACE_NAME = re.compile(r"\w(?:[\w .-]{0,38}[\w.-])?")
"""Names of places and zones."""

PLACE_RULE = "at most 40 letters, digits, blanks, '_', '-' and '.'"
_NAME = re.compile(rf"[A-Za-z][A-Za-z0-9_.-]{{0,{LONGEST - 1}}}")
# roslaunch reads these as a number or a truth value, wherever a text may be one.
_RESERVED = frozenset({LATEST, "true", "false", "inf", "infinity", "nan", "none"})


def is_map_name(name: str) -> bool:
    """Return whether a text is a valid name of a map."""
    return bool(_NAME.fullmatch(name)) and name.lower() not in _RESERVED and not name.endswith(".")


def check_map_name(name: str) -> str:
    """Return a valid name of a map unchanged. Raises UserError for any other text."""
    if is_map_name(name):
        return name
    if name.lower() in _RESERVED:
        message = f"map name {printable(name)!r} is reserved, expected another one"
    else:
        message = (
            f"map name {printable(name[: 2 * LONGEST])!r}, expected a letter, then letters, digits, '-', '_' and '.', "
            f"at most {LONGEST} in all"
        )
    raise user_error(message, rule="bad-name", help=_offer(name) or "for example flat or second-floor")


def _offer(name: str) -> str:
    """Return a valid name that differs only in its blanks; empty if there is none."""
    changed = re.sub(r"\s+", "_", name.strip())
    return f"name it {changed}" if changed != name and is_map_name(changed) else ""


def fresh_name(day: str, taken: Collection[str]) -> str:
    """Return a free name for a map: `map-DAY`, then `map-DAY-2` and so on."""
    name, number = f"map-{day}", 1
    while name in taken:
        number += 1
        name = f"map-{day}-{number}"
    return name
