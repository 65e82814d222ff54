"""The table of releases: whether a Linux distribution packages ROS 1. Pure, except for reading the table itself."""

import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Literal, cast

from ur.source.diagnostic import user_error_about

_ROBOTS = "Debian 12 or 13, or Raspberry Pi OS 12 or 13 (64 bits)"

Ros = Literal["native", "brought", "refused"]
COLUMNS = ("id", "version", "codename", "ros", "missing", "lists", "tried", "name", "note")
_ANY = "*"
_NO_HIT = 99


@dataclass(frozen=True, slots=True)
class Release:
    """A row of the table; its columns are described at the head of releases.tsv. Empty values are ''.

    `missing` is ("all", ...) if the release has no ROS package. `tried` is False for a derivative.
    """

    id: str
    version: str
    codename: str
    ros: Ros
    missing: tuple[str, ...]
    lists: str
    tried: bool
    name: str
    note: str


@dataclass(frozen=True, slots=True)
class System:
    """Identification of a system, from its os-release. `name` is its display name."""

    id: str = "linux"
    like: tuple[str, ...] = ()
    version: str = ""
    codename: str = ""
    ubuntu: str = ""
    debian: str = ""
    name: str = "Linux"


def parse_os_release(text: str) -> System:
    """Parse the text of an os-release file (os-release(5)). Lines that are not assignments are ignored."""
    values: dict[str, str] = {}
    for line in text.splitlines():
        key, equals, value = line.strip().partition("=")
        if not equals or not re.fullmatch(r"[A-Z0-9_]+", key):
            continue
        try:
            values[key] = "".join(shlex.split(value))
        except ValueError:
            continue
    return System(
        id=values.get("ID", "linux"),
        like=tuple(values.get("ID_LIKE", "").split()),
        version=values.get("VERSION_ID", ""),
        codename=values.get("VERSION_CODENAME", ""),
        ubuntu=values.get("UBUNTU_CODENAME", ""),
        debian=values.get("DEBIAN_CODENAME", ""),
        name=values.get("PRETTY_NAME", "Linux"),
    )


def parse_releases(text: str) -> tuple[Release, ...]:
    """Parse the table. Raises ValueError, which names the line, if it is malformed."""
    lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line and not line.startswith("#")]
    if not lines or tuple(lines[0][1].split("\t")) != COLUMNS:
        raise ValueError(f"releases.tsv: expected the columns {' '.join(COLUMNS)}")
    return tuple(_parse_row(number, line) for number, line in lines[1:])


def _parse_row(number: int, line: str) -> Release:
    cells = line.split("\t")
    if len(cells) != len(COLUMNS) or "" in cells:
        raise ValueError(f"releases.tsv:{number}: expected {len(COLUMNS)} columns, each with a value or -")
    row: Mapping[str, str] = {key: "" if cell == "-" else cell for key, cell in zip(COLUMNS, cells, strict=True)}
    if row["ros"] not in ("native", "brought", "refused"):
        raise ValueError(f"releases.tsv:{number}: ros is {row['ros']!r}, expected native, brought or refused")
    if row["tried"] not in ("yes", "no"):
        raise ValueError(f"releases.tsv:{number}: tried is {row['tried']!r}, expected yes or no")
    return Release(
        id=row["id"],
        version=row["version"],
        codename=row["codename"],
        ros=cast(Ros, row["ros"]),
        missing=tuple(row["missing"].split(",")) if row["missing"] else (),
        lists=row["lists"],
        tried=row["tried"] == "yes",
        name=row["name"],
        note=row["note"],
    )


@cache
def load_releases() -> tuple[Release, ...]:
    """Return all rows of the project's table, in order."""
    return parse_releases(files("ur.system").joinpath("releases.tsv").read_text("utf-8"))


def load_ros_packages() -> tuple[str, ...]:
    """Return the Debian packages of ROS 1 that the set-up installs; alternatives within an entry are separated by |."""
    lines = files("ur.system").joinpath("ros_packages.txt").read_text("utf-8").splitlines()
    return tuple(line for line in lines if line and not line.startswith("#"))


def find_release(system: System) -> Release:
    """Return the row of the table for a system, by the order that the head of the table describes."""
    rows = load_releases()
    ranks = [_rank(row, system) for row in rows]
    best = min(ranks)
    found = rows[ranks.index(best)]
    return found if best == 1 else replace(found, tried=False)


def check_robot_system(place: str, system: System) -> None:
    """Raise UserError if a robot with this system cannot have ROS 1. `place` names its address or image.

    The Debian root, which provides ROS 1 on users' computers, is not for robots.
    """
    if reason := describe_lack(system):
        raise user_error_about(
            place, f"{reason}, expected {_ROBOTS}", rule="unsupported-release", help="flash an image of one of these"
        )


def describe_lack(system: System) -> str:
    """Describe why a system has no packages of ROS 1, as a clause that begins with its name; '' if it has them."""
    release = find_release(system)
    if release.ros == "native":
        return ""
    if release.ros == "brought":
        return f"{system.name} does not package ROS 1"
    return f"{system.name} is not supported" + (f": {release.note}" if release.note else "")


def _rank(row: Release, system: System) -> int:
    """Return the step of the look-up at which a row matches."""
    testing = not system.version and system.codename and row.codename == system.codename
    if row.id == system.id and (row.version == system.version or testing):
        return 1
    if row.id == system.id and row.version == _ANY:
        return 2
    if row.codename and _is_base(row, system):
        return 3
    if row.version == _ANY:
        if row.id in system.like:
            return 4 + system.like.index(row.id)
        if row.id == _ANY:
            return _NO_HIT - 1
    return _NO_HIT


def _is_base(row: Release, system: System) -> bool:
    """Return whether a derivative declares that it is based on the release of this row."""
    if system.ubuntu:
        return row.id == "ubuntu" and row.codename == system.ubuntu
    if system.debian:
        return row.id == "debian" and row.codename == system.debian
    return row.id in system.like and row.codename == system.codename
