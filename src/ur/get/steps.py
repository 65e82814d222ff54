"""Values of `ur get`: missing packages, and the plan to get them."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

Way = Literal["debian", "other", "pypi", "source", "unknown"]
PACKAGE_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,99}")  # REP 127, and the capitals that old packages have


@dataclass(frozen=True, slots=True)
class SourceRepository:
    """A repository of source code, as the index of a ROS distribution names it.

    `distribution` is that of the index ("kinetic"), "" where it is not an older one than noetic. `url` and `version`
    hold only characters that a shell leaves alone; `type` is git, hg or svn. `linked`: a text only links to it.
    """

    name: str
    type: str
    url: str
    version: str
    distribution: str = ""
    linked: bool = False


@dataclass(frozen=True, slots=True)
class Missing:
    """A package that is not installed. `program` is set where only this program of an installed package is missing.

    `named_in` is a file that names it, where that is known. `owners` are the addresses below which its authors may
    have it ("https://github.com/NAME"), `others` those of repositories that files of the folder clone, or
    that begin with the package's first word and are linked to. `renamed` is the package of the same folder that is
    probably meant; `hidden`, a folder that has its package.xml and in which ROS does not find it; `itself`, the folder
    of the repository that has its name.
    """

    package: str
    program: str = ""
    named_in: str = ""
    owners: tuple[str, ...] = ()
    renamed: str = ""
    hidden: str = ""
    others: tuple[str, ...] = ()
    itself: str = ""


@dataclass(frozen=True, slots=True)
class Needs:
    """Missing packages, a test for packages that are there, and notes on what could not be read.

    `hints` are the repositories that the files of folders name, and `names` the packages that are there.
    """

    missing: tuple[Missing, ...]
    is_there: Callable[[str], bool]
    notes: tuple[str, ...] = ()
    hints: tuple[SourceRepository, ...] = ()
    names: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class InstallStep:
    """One missing package and the way to get it.

    The way is "other" for a Debian package that is not one of ROS: a stranger's package.xml may name any.
    `names` are Debian packages, or PyPI's project; `repository` is set for "source". `needs` are the packages that it
    depends on and that are missing as well; None where its package.xml is unknown before it is here. `reason` says
    for "unknown" why there is no way, and for "source" what is special about its repository. `here`: nothing has to be
    installed, the reason says what to change in the folder. `chosen`: the user has agreed to it already.
    """

    missing: Missing
    way: Way
    names: tuple[str, ...] = ()
    repository: SourceRepository | None = None
    needs: tuple[str, ...] | None = None
    reason: str = ""
    here: bool = False
    chosen: bool = False


@dataclass(frozen=True, slots=True)
class GetPlan:
    """All missing packages with their ways, sorted by package. `notes` name the tables and indices that are missing."""

    steps: tuple[InstallStep, ...]
    notes: tuple[str, ...] = ()

    def steps_by(self, way: Way) -> tuple[InstallStep, ...]:
        """The steps of one way."""
        return tuple(step for step in self.steps if step.way == way)

    @property
    def debian(self) -> tuple[str, ...]:
        """The Debian packages to install, each once."""
        return tuple(dict.fromkeys(name for step in self.steps_by("debian") for name in step.names))

    @property
    def installs(self) -> bool:
        """True where something of the plan is installed by `ur get` itself."""
        return bool(self.steps_by("debian") or self.steps_by("pypi"))
