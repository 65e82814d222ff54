"""The folders around a description: its files are read but never executed.

The search for parent folders ends at the first folder that another user may write to: in a folder like /tmp, another
user could have placed a package around the description.
"""

import os
import stat
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice, takewhile
from pathlib import Path

_CUSTOMARY = frozenset({"urdf", "xacro", "robots", "robot", "description"})  # folders beside that of the meshes
_MOST_BESIDE = 1000  # folders beside a package that are searched


@dataclass(frozen=True, slots=True)
class Surroundings:
    """The resolved file of a description, the outermost folder that belongs to it, and the packages around it.

    `folder` is that of the repository, else of the package, else of the file. `packages` are its own package, which
    comes first, and those beside it. `home` is the user's home folder, which never counts as a repository.
    """

    file: Path
    folder: Path
    packages: tuple[Path, ...] = ()
    home: Path = Path("/nonexistent")

    def holds(self, path: str | Path) -> bool:
        """Return whether a file or folder lies in the folder of the description, with symbolic links resolved."""
        place = Path(os.path.realpath(path))
        beside = [self.packages[0].parent] if self.packages else []
        folders = (self.folder, *self.packages, *beside)
        return any(self._covers(folder, place) for folder in folders)

    def find_readable(self, path: str | Path, packages: Iterable[str] = ()) -> Path | None:
        """Return the resolved file if the description may read it: in its folder or in a package, and not hidden there.

        `packages` are the folders of further packages.
        """
        place = Path(os.path.realpath(path))
        for folder in (self.folder, *self.packages, *(Path(os.path.realpath(each)) for each in packages)):
            if self._covers(folder, place):
                return None if any(part[0] == "." for part in place.relative_to(folder).parts) else place
        return None

    def _covers(self, folder: Path, path: Path) -> bool:
        """Return whether a path is in a folder; in the home folder, only files directly in it count."""
        wide = _is_wide(folder, self.home)
        return path.parent == folder if wide else path.is_relative_to(folder)


def find_surroundings(path: Path, environment: Mapping[str, str]) -> Surroundings:
    """Find the surroundings of an existing file. Raises OSError."""
    file = Path(os.path.realpath(path))
    home = Path(os.path.realpath(environment.get("HOME") or "/nonexistent"))
    owners = {0, os.geteuid(), path.stat().st_uid}
    above = list(takewhile(lambda each: _is_safe(each, owners), file.parents))
    inside = [folder for folder in above if folder == file.parent or not _is_wide(folder, home)]
    package = next((folder for folder in inside if _has_manifest(folder)), None)
    repository = [folder for folder in inside if (folder / ".git").exists()]
    customary = [folder.parent for folder in inside if folder.name in _CUSTOMARY and folder.parent in inside]
    outermost = min((*repository, package or file.parent, *customary[:1]), key=lambda folder: len(folder.parts))
    packages: tuple[Path, ...] = ()
    if package is not None:
        beside = _list_beside(package) if package.parent in above else ()
        packages = (package, *beside)
    return Surroundings(file, outermost, packages, home)


def is_safe_program(path: str) -> bool:
    """Return whether only root and the user could have placed a program, or a link to it, at this path."""
    owners = {0, os.geteuid()}
    real = os.path.realpath(path)
    places = (os.path.dirname(path), os.path.dirname(real), real)  # noqa: PTH120 - links are kept
    return all(_is_safe(Path(place), owners) for place in places)


def _is_safe(path: Path, owners: set[int]) -> bool:
    try:
        status = path.stat()
    except OSError:
        return False
    return status.st_uid in owners and not status.st_mode & stat.S_IWOTH


def _is_wide(folder: Path, home: Path) -> bool:
    """Return whether a folder is the root, the home folder, or a parent of it."""
    return home.is_relative_to(folder) or folder == Path("/")


def _has_manifest(folder: Path) -> bool:
    try:
        return stat.S_ISREG((folder / "package.xml").lstat().st_mode)
    except OSError:
        return False


def _list_beside(package: Path) -> tuple[Path, ...]:
    def walk() -> Iterator[Path]:
        with os.scandir(package.parent) as entries:
            for entry in islice(entries, _MOST_BESIDE):
                if entry.is_dir(follow_symlinks=False) and entry.name != package.name:
                    yield Path(entry.path)

    try:
        return tuple(folder for folder in sorted(walk()) if _has_manifest(folder))
    except OSError:
        return ()
