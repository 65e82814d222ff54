"""Needs of launch files and programs from a base: the comment `<!--Needs: ...-->`, compared with what a base has.

A need is the key of a sensor (`ur.robot.base.SENSORS`). Several are separated by blanks, alternatives by a bar:
`<!--Needs: raspicam lidar|sonars-->`.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ur.launchfile.syntax import LaunchFile
from ur.launchfile.syntax.parse import parse_launch_file
from ur.launchfile.world.protocol import World
from ur.robot.base import SENSORS, Base, list_variants, load_base

NEEDS = "Needs:"
Need = tuple[str, ...]
"""Alternatives: a base that has one of them has what is needed."""


def read_needs(path: str, world: World) -> tuple[Need, ...]:
    """Return the needs of a file, as `find_needs` does; empty if it cannot be read."""
    try:
        return find_needs(parse_launch_file(path, world.read_bytes(path)))
    except OSError:
        return ()


def find_needs(parsed: LaunchFile) -> tuple[Need, ...]:
    """Return the needs that a comment directly in `<launch>` names, in order."""
    launch = parsed.launch
    texts = [comment.text for comment in launch.comments] if launch is not None else []
    names = [
        name for text in texts if text.startswith(NEEDS) for name in text.removeprefix(NEEDS).replace(",", " ").split()
    ]
    return tuple(tuple(name.split("|")) for name in names)


def list_lacks(base: Base, needs: Sequence[Need]) -> tuple[Need, ...]:
    """Return the needs that a base does not meet."""
    return tuple(need for need in needs if not any(getattr(base, name, None) for name in need))


def find_variants(package: Path, base: Base, needs: Sequence[Need]) -> tuple[str, ...]:
    """Return the variants of the same base that meet all needs, '' for the plain one."""
    variants = ("", *list_variants(package, base.name))
    return tuple(each for each in variants if not list_lacks(load_base(package, base.name, each), needs))


def describe_need(need: Need) -> str:
    """Describe a need: `a lidar`, `a lidar or sonars`."""
    return " or ".join(f"{SENSORS[name].article} {name}".strip() if name in SENSORS else name for name in need)


def describe_lack(base: Base, lacks: Sequence[Need]) -> str:
    """Describe unmet needs as a clause: `magni has no lidar, no sonars`. `lacks` must not be empty."""
    names = ", ".join(f"no {name}" for need in lacks for name in need)
    return f"{describe_base(base)} has {names}"


def describe_base(base: Base) -> str:
    """Return a base and its variant, as `ur use` writes them: `magni:lidar`."""
    return f"{base.name}:{base.variant}" if base.variant else base.name
