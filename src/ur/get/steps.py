"""Values of `ur get`: missing packages, and the plan to get them."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

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


Method = Literal["debian", "other", "pypi", "source", "unknown"]
PACKAGE_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,99}")  # REP 127, and the capitals that old packages have


@dataclass(frozen=True, slots=True)
class SourceRepository:
    """A repository of source code, as the index of a ROS distribution names it.

    `distribution` is that of the index ("kinetic"), "" unless it is older than noetic. `url` and `version` contain only
    characters that are safe in a shell; `type` is git, hg or svn.
    """

    name: str
    type: str
    url: str
    version: str
    distribution: str = ""


@dataclass(frozen=True, slots=True)
class Missing:
    """A package that is not installed.

    `program` is set if only this program of an installed package is missing. `named_in` is a file that names it, if
    known.
    """

    package: str
    program: str = ""
    named_in: str = ""


@dataclass(frozen=True, slots=True)
class Needs:
    """Missing packages, a test for installed ones, notes on unreadable files, and the names of installed packages."""

    missing: tuple[Missing, ...]
    is_there: Callable[[str], bool]
    notes: tuple[str, ...] = ()
    names: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class InstallStep:
    """One missing package and its source (`method`).

    The method is "other" for a Debian package outside of ROS, since an untrusted package.xml may name any. `names` are
    Debian packages, or the project on PyPI; `repository` is set for "source". `needs` are its missing dependencies;
    None while its package.xml is unknown. `reason` explains for "unknown" why there is no source, and for "source"
    peculiarities of its repository. `chosen`: the user has already agreed to it.
    """

    missing: Missing
    method: Method
    names: tuple[str, ...] = ()
    repository: SourceRepository | None = None
    needs: tuple[str, ...] | None = None
    reason: str = ""
    chosen: bool = False


@dataclass(frozen=True, slots=True)
class GetPlan:
    """All missing packages with their sources, sorted by package. `notes` name missing tables and indexes."""

    steps: tuple[InstallStep, ...]
    notes: tuple[str, ...] = ()

    def steps_by(self, method: Method) -> tuple[InstallStep, ...]:
        """Return the steps of one method."""
        return tuple(step for step in self.steps if step.method == method)

    @property
    def debian(self) -> tuple[str, ...]:
        """Return the Debian packages to install, each once."""
        return tuple(dict.fromkeys(name for step in self.steps_by("debian") for name in step.names))

    @property
    def installs(self) -> bool:
        """True if `ur get` itself installs a part of the plan."""
        return bool(self.steps_by("debian") or self.steps_by("pypi"))
