"""Names of stored maps, which are safe in a shell, a launch file and a file system, and of what is on them."""

import re
from collections.abc import Collection

from ur.source.diagnostic import UserError, error
from ur.source.printable import printable

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
    raise UserError(error(message, rule="bad-name", help=_offer(name) or "for example flat or second-floor"))


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
