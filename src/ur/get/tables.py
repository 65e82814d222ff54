"""Debian package names of ROS packages: the table of Debian's rosdep, and the naming rules of apt packages."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ur.get.steps import PACKAGE_NAME
from ur.source.foreign.yaml_text import load_yaml

_DEBIAN_NAME = re.compile(r"[a-z0-9][a-z0-9+.-]+")  # Debian policy 5.6.1
_MAX_TABLE = 4 * 1024 * 1024
# Debian splits these: the program is in one package, the rest of the ROS package in another.
SPLIT: Mapping[str, tuple[str, ...]] = {
    "image_transport": ("image-transport-tools", "libimage-transport-dev"),
    "image_view": ("ros-image-view", "libimage-view-dev"),
    "joint_state_publisher": ("joint-state-publisher",),
    "rviz": ("rviz",),
    "topic_tools": ("topic-tools", "libtopic-tools-dev"),
}
PYPI: Mapping[str, str] = {"xacro": "xacro"}


@dataclass(frozen=True, slots=True)
class DebianPackage:
    """A Debian package that apt can install. `for_ros`: its maintainers or home page belong to ROS."""

    name: str
    for_ros: bool


def parse_table(text: str) -> dict[str, tuple[str, ...]]:
    """Parse a table of rosdep (`PACKAGE: {debian: [NAME, ...]}`), without entries of another form.

    Raises ValueError if the text is too long or is not such a table.
    """
    if len(text) > _MAX_TABLE:
        raise ValueError(f"more than {_MAX_TABLE:,} characters, expected a table of rosdep")
    try:
        table = load_yaml(text)
    except ValueError as problem:
        raise ValueError(f"not YAML: {problem}") from None
    if not isinstance(table, dict):
        raise ValueError("no mapping of packages, expected a table of rosdep")
    found = {}
    for package, entry in table.items():
        names = entry.get("debian") if isinstance(entry, dict) else None
        if isinstance(names, list) and names and _is_package(package) and all(map(_is_debian_name, names)):
            found[package] = tuple(names)
    return found


def possible_names(package: str, distribution: str = "") -> tuple[tuple[str, ...], ...]:
    """Return the sets of Debian packages that may contain a ROS package, best first, by the naming rules.

    `distribution` ("noetic") is that of packages.ros.org.
    """
    dashed = package.replace("_", "-").lower()
    sets = [(f"ros-{distribution}-{dashed}",)] if distribution else []
    sets += [(f"ros-{dashed}",), (dashed,), (f"python3-{dashed}",), (f"lib{dashed}-dev",)]
    return tuple(names for names in sets if all(map(_is_debian_name, names)))


def parse_candidates(text: str) -> dict[str, DebianPackage]:
    """Parse the output of `apt-cache show`: the packages that apt can install, by name."""
    found = {}
    for paragraph in text.split("\n\n"):
        fields = dict(line.split(": ", 1) for line in paragraph.splitlines() if ": " in line and line[0] != " ")
        name = fields.get("Package", "")
        if not _is_debian_name(name) or "Filename" not in fields:
            continue
        home = fields.get("Homepage", "")
        for_ros = (
            name.startswith("ros-")
            or any(part in home for part in ("wiki.ros.org", "ros.org/", "github.com/ros"))
            or "robotics" in fields.get("Maintainer", "").lower()
        )
        found[name] = DebianPackage(name, for_ros)
    return found


def all_names(packages: Iterable[str], table: Mapping[str, tuple[str, ...]], distribution: str) -> tuple[str, ...]:
    """Return every possible Debian name of the packages, for a single query to apt."""
    names: dict[str, None] = {}
    for package in packages:
        names.update(dict.fromkeys((*table.get(package, ()), *SPLIT.get(package, ()))))
        for each in possible_names(package, distribution):
            names.update(dict.fromkeys(each))
    return tuple(names)


def _is_package(name: object) -> bool:
    return isinstance(name, str) and PACKAGE_NAME.fullmatch(name) is not None


def _is_debian_name(name: object) -> bool:
    return isinstance(name, str) and _DEBIAN_NAME.fullmatch(name) is not None
