"""The interface between the launch language and a computer: packages, files and variables."""

from collections.abc import Iterable, Mapping
from typing import Protocol


class PackageNotFound(LookupError):  # noqa: N818 - named as rospkg's ResourceNotFound is
    """No package has this name. `str(problem)` is the name."""


class World(Protocol):
    """Packages, files and environment. Answers do not change during the lifetime of the object."""

    @property
    def environment(self) -> Mapping[str, str]:
        """The environment variables."""
        ...

    def find_package(self, name: str) -> str:
        """Return the folder of a package.

        Raises PackageNotFound; OSError or ValueError for an unreadable package.xml.
        """
        ...

    def package_names(self) -> Iterable[str]:
        """Return the names of all packages, for suggestions."""
        ...

    def find_in_package(self, package: str, path: str) -> str | None:
        """Resolve `$(find package)/path` outside the package's folder: an installed program or file.

        `path` has no leading slash. Returns None if there is none. Raises PackageNotFound.
        """
        ...

    def find_files(self, package: str, name: str) -> tuple[str, ...]:
        """Return all files called `name` in a package, searched as roslaunch does. Raises PackageNotFound."""
        ...

    def find_executables(self, package: str, name: str) -> tuple[str, ...]:
        """Return the executable files of `find_files`; a node runs the first. Raises PackageNotFound."""
        ...

    def executable_names(self, package: str) -> Iterable[str]:
        """Return the names of all executables in a package, for suggestions. Raises PackageNotFound."""
        ...

    def is_file(self, path: str) -> bool:
        """Return whether a path names a file."""
        ...

    def read_bytes(self, path: str) -> bytes:
        """Return the content of a file. Raises OSError."""
        ...

    def list_folder(self, path: str) -> tuple[str, ...]:
        """Return the names in a folder, for suggestions; empty if there is no such folder."""
        ...

    def absolute(self, path: str) -> str:
        """Return a path from the root, without `.` and `..`."""
        ...

    def make_anonymous(self, prefix: str) -> str:
        """Return a unique node name: `$(anon prefix)`."""
        ...
