"""Finding installed files as catkin does: workspaces from CMAKE_PREFIX_PATH, then /usr.

Source of the rules: catkin's `find_in_workspaces` and `workspace`, as Debian ships them.
"""

# Paths are texts here: pathlib would change what roslaunch prints, and costs too much in hot loops.
# ruff: noqa: PTH110, PTH113, PTH118

from __future__ import annotations

import os
from collections.abc import Mapping

from ur.launchfile.world.links import walk_links
from ur.launchfile.world.packages import read_package_name
from ur.source.foreign.files import MAX_MANIFEST, read_text

MARKER = ".catkin"
_IGNORE = frozenset({"AMENT_IGNORE", "CATKIN_IGNORE", "COLCON_IGNORE"})


class Workspaces:
    """The workspaces of an environment, most important first. Their source folders are read when they are needed."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        prefixes = [path for path in environment.get("CMAKE_PREFIX_PATH", "").split(os.pathsep) if path]
        self.folders = [path for path in prefixes if os.path.isfile(os.path.join(path, MARKER))]
        self.folders.append("/usr")
        self._sources: dict[str, list[str]] = {}
        self._packages: dict[str, dict[str, str]] = {}

    def find(self, kinds: tuple[str, ...], package: str, path: str | None = None) -> list[str]:
        """Existing places of a package in the first workspace that has any. `kinds`: `lib`, `libexec`, `share`."""
        for workspace in self.folders:
            found = []
            for kind in kinds:
                place = os.path.join(workspace, kind, package, *([path] if path else []))
                if os.path.exists(place):
                    found.append(place)
                if kind == "share":
                    found.extend(self._find_source(workspace, package, path))
            if found:
                return found
        return []

    def _find_source(self, workspace: str, package: str, path: str | None) -> list[str]:
        found = []
        for source in self._source_paths(workspace):
            if source not in self._packages:
                self._packages[source] = _crawl(source)
            folder = self._packages[source].get(package)
            if folder is not None:
                place = os.path.join(source, folder) if folder != os.curdir else source
                place = os.path.join(place, path) if path else place
                if os.path.exists(place):
                    found.append(place)
        return found

    def _source_paths(self, workspace: str) -> list[str]:
        if workspace == "/usr":
            return []
        if workspace not in self._sources:
            paths: dict[str, str] = {}
            try:
                for path in read_text(os.path.join(workspace, MARKER), MAX_MANIFEST, errors="strict").split(";"):
                    if path:
                        paths.setdefault(os.path.realpath(path), path)
            except (OSError, ValueError):
                paths = {}
            self._sources[workspace] = list(paths.values())
        return self._sources[workspace]


def _crawl(source: str) -> dict[str, str]:
    # Package name to folder, relative to the source folder.
    found: dict[str, str] = {}
    for folder, folders, files in walk_links(source):
        if _IGNORE.intersection(folders, files) or _IGNORE.intersection(files):
            folders.clear()
            continue
        if "package.xml" in files:
            try:
                name = read_package_name(os.path.join(folder, "package.xml"))
            except (OSError, ValueError):
                name = None
            if name is not None:
                found.setdefault(name, os.path.relpath(folder, source))
            folders.clear()
            continue
        folders[:] = [name for name in folders if not name.startswith(".")]
    return found
