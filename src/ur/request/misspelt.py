"""Arguments in the form of another tool: `world=office`, `--world office`, `office`."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence

from ur.source.suggest import did_you_mean

_PLAIN = re.compile(r"[\w./+-]+")


def suggest_assignment(text: str, declared: Sequence[str], following: str = "") -> str:
    """Return a misspelt argument in the form `NAME:=VALUE`, '' if no argument of the launch file is similar.

    `declared` are the names of the arguments. The value is the text after `=`, else `following`, else dots. A text
    without a name is taken as the value of an argument that has such values: a world, a map, a base.
    """
    bare, assigned, value = text.lstrip("-").partition("=")
    owner = "" if assigned or text.startswith("-") else _owner(bare, declared)
    if owner:
        return f"{owner}:={bare}"
    name = did_you_mean(bare.replace("-", "_"), declared)
    return write_assignment(name, value or following) if name else ""


def write_assignment(name: str, value: str) -> str:
    """Return `NAME:=VALUE`, with dots for a value that is empty or unsafe for a shell or a terminal."""
    return f"{name}:={value if _PLAIN.fullmatch(value) else '...'}"


def _owner(word: str, declared: Sequence[str]) -> str:
    return next((name for name, values in _known_values() if name in declared and word in values), "")


def _known_values() -> Iterator[tuple[str, Sequence[str]]]:
    from ur.maps.store import own_store
    from ur.request.environment import PACKAGE
    from ur.robot.base import list_bases
    from ur.worlds.choice import WORLD, list_worlds

    yield WORLD, list_worlds(PACKAGE)
    yield "robot_base", list_bases(PACKAGE)
    yield "map", own_store(os.environ).names()
