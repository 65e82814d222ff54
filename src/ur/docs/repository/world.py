"""The world of a launch repository alone, so that documents are the same with any installed packages."""

import posixpath
from collections.abc import Iterable, Mapping

from ur.launchfile.world import World

# A letter that no launch file uses, the marker of unknown values: findings that contain it are dropped.
_UNKNOWN = "ǂ"
_ELSEWHERE = f"/{_UNKNOWN}"


class RepositoryWorld:
    """Packages of the repository as they are; every other package has an imaginary folder. No environment variables."""

    def __init__(self, world: World, packages: Mapping[str, str]) -> None:
        self._world = world
        self._packages = dict(packages)
        self.environment: Mapping[str, str] = {}

    def find_package(self, name: str) -> str:
        """See World. Raises nothing."""
        return self._packages.get(name, f"{_ELSEWHERE}{name}")

    def package_names(self) -> Iterable[str]:
        return self._packages.keys()

    def find_in_package(self, package: str, path: str) -> str | None:  # noqa: ARG002 - World
        """See World. Installed files outside of the repository are ignored."""
        return None

    def find_files(self, package: str, name: str) -> tuple[str, ...]:  # noqa: ARG002 - World
        """See World. Not used here."""
        return ()

    def find_executables(self, package: str, name: str) -> tuple[str, ...]:  # noqa: ARG002 - World
        """See World. Not used here."""
        return ()

    def executable_names(self, package: str) -> Iterable[str]:  # noqa: ARG002 - World
        """See World. Not used here."""
        return ()

    def is_file(self, path: str) -> bool:
        """See World. A parameter file with an unknown path counts as existing."""
        return path.endswith((".yaml", ".yml")) if _UNKNOWN in path else self._world.is_file(path)

    def read_bytes(self, path: str) -> bytes:
        """See World.

        A file outside of the repository, or with an unknown path, counts as empty, so that its node is kept.
        """
        return b"{}" if _UNKNOWN in path else self._world.read_bytes(path)

    def list_folder(self, path: str) -> tuple[str, ...]:
        return () if _UNKNOWN in path else self._world.list_folder(path)

    def absolute(self, path: str) -> str:
        if path.startswith("/"):
            return path if "//" not in path and "/." not in path else posixpath.normpath(path)
        return self._world.absolute(path)

    def make_anonymous(self, prefix: str) -> str:
        """See World. The name is always the same."""
        return f"{prefix}_anonymous"


def is_elsewhere(path: str) -> bool:
    """Return whether a path is in a package that is not part of the repository."""
    return path.startswith(_ELSEWHERE)


def show_elsewhere(path: str) -> str:
    """Return such a path as written: `$(find package)/rest`."""
    package, slash, rest = path.removeprefix(_ELSEWHERE).partition("/")
    return f"$(find {package}){slash}{rest}"


def is_unknown(text: str) -> bool:
    """Return whether a text contains a value that depends on the user's input."""
    return _UNKNOWN in text
