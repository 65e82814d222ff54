"""The interface between the launch language and a computer: packages, files and variables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol


class PackageNotFound(LookupError):  # noqa: N818 - named as rospkg's ResourceNotFound is
    """No package has this name. `str(problem)` is the name."""


class World(Protocol):
    """Packages, files and environment. Answers stay the same for as long as the world lives."""

    @property
    def environment(self) -> Mapping[str, str]:
        """The environment variables."""
        ...

    def find_package(self, name: str) -> str:
        """The folder of a package. Raises PackageNotFound; OSError or ValueError when a package.xml cannot be read."""
        ...

    def package_names(self) -> Iterable[str]:
        """Every package there is, for suggestions."""
        ...

    def find_in_package(self, package: str, path: str) -> str | None:
        """Resolve `$(find package)/path` outside the package's folder: an installed program or file.

        `path` has no leading slash. None when nothing special is there. Raises PackageNotFound.
        """
        ...

    def find_files(self, package: str, name: str) -> tuple[str, ...]:
        """All files called `name` that belong to a package, searched as roslaunch does. Raises PackageNotFound."""
        ...

    def find_executables(self, package: str, name: str) -> tuple[str, ...]:
        """As find_files, only those that may be executed; a node runs the first. Raises PackageNotFound."""
        ...

    def executable_names(self, package: str) -> Iterable[str]:
        """The names of everything in a package that may be executed, for suggestions. Raises PackageNotFound."""
        ...

    def is_file(self, path: str) -> bool:
        """Return whether a path names a file."""
        ...

    def read_bytes(self, path: str) -> bytes:
        """The content of a file. Raises OSError."""
        ...

    def list_folder(self, path: str) -> tuple[str, ...]:
        """The names in a folder, for suggestions; empty when there is no such folder."""
        ...

    def absolute(self, path: str) -> str:
        """A path from the root, without `.` and `..`."""
        ...

    def make_anonymous(self, prefix: str) -> str:
        """A node name that no other node has: `$(anon prefix)`."""
        ...
