"""Values of `ur get`: missing packages, and the plan to get them."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

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
