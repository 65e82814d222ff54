"""The real world for a check: checked packages take precedence, and packages beside them are known without sourcing."""

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from ur.launchfile.world import SystemWorld

_MAX_DEPTH = 6
_MAX_BESIDE = 20_000


def make_world(paths: Sequence[str], environment: Mapping[str, str]) -> SystemWorld:
    """Return this computer's world, in which the checked packages come first and those beside them last."""
    checked: dict[str, None] = {}
    beside: dict[str, None] = {}
    for path in map(Path, paths):
        place = path.absolute()
        enclosing = next((each for each in (place, *place.parents) if _is_package(each)), None)
        if enclosing is not None:
            checked[str(enclosing)] = None
            beside.update(dict.fromkeys(_beside(enclosing)))
        elif os.path.isdir(place):  # noqa: PTH112 - likewise
            checked.update(dict.fromkeys(_below(place)))
    known = [environment["ROS_PACKAGE_PATH"]] if environment.get("ROS_PACKAGE_PATH") else []
    joined = os.pathsep.join((*checked, *known, *(path for path in beside if path not in checked)))
    return SystemWorld({**environment, "ROS_PACKAGE_PATH": joined} if joined else environment)


def _is_package(folder: Path) -> bool:
    return os.path.isfile(folder / "package.xml")  # noqa: PTH113 - Path.is_file fails where a folder may not be read


def _beside(folder: Path) -> Iterator[str]:
    for each in _folders(folder.parent):
        if _is_package(each):
            yield str(each)


def _below(folder: Path, depth: int = 0) -> Iterator[str]:
    for each in _folders(folder):
        if _is_package(each):
            yield str(each)
        elif depth < _MAX_DEPTH:
            yield from _below(each, depth + 1)


def _folders(folder: Path) -> Iterable[Path]:
    try:
        found = [entry for entry in os.scandir(folder) if entry.is_dir() and not entry.name.startswith(".")]
    except OSError:
        return ()
    return [Path(entry.path) for entry in sorted(found, key=lambda entry: entry.name)[:_MAX_BESIDE]]


class FileWatch:
    """The files and folders below paths, with the times of their changes."""

    def __init__(self, paths: Sequence[str]) -> None:
        self._paths = [os.path.abspath(path) for path in paths]  # noqa: PTH100 - texts throughout
        self._stamps = dict(self._look())

    def pop_changes(self) -> list[str]:
        """Return the sorted paths that were written, created or removed since the last call."""
        before, self._stamps = self._stamps, dict(self._look())
        return sorted(path for path in {*before, *self._stamps} if before.get(path) != self._stamps.get(path))

    def _look(self) -> Iterator[tuple[str, tuple[int, int, int]]]:
        waiting = list(self._paths)
        while waiting:
            path = waiting.pop()
            try:
                status = os.stat(path)  # noqa: PTH116 - likewise
                if os.path.isdir(path):  # noqa: PTH112 - likewise
                    with os.scandir(path) as entries:
                        waiting.extend(entry.path for entry in entries if not entry.name.startswith("."))
                    continue  # a folder changes with each file in it
            except OSError:
                continue
            yield path, (status.st_mtime_ns, status.st_size, status.st_mode)
