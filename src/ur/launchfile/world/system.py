"""The world of the running computer."""

# Paths are texts here: pathlib would change what roslaunch prints, and costs too much in hot loops.
# ruff: noqa: PTH100, PTH110, PTH113, PTH116, PTH118, PTH119, PTH208
from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping

from ur.launchfile.world.packages import find_packages, package_paths, read_package_name, walk_links
from ur.launchfile.world.protocol import PackageNotFound
from ur.source.foreign.files import MAX_MANIFEST, read_file, read_text
from ur.source.user_folders import MARKER, list_workspaces

_IGNORE = frozenset({"AMENT_IGNORE", "CATKIN_IGNORE", "COLCON_IGNORE"})

MAX_READ = 256 * 1024 * 1024
_OWNER_MAY_RUN = stat.S_IRUSR | stat.S_IXUSR


class SystemWorld:
    """The real packages, files and environment.

    Packages are searched once, on first use; a new object sees later changes.
    """

    def __init__(
        self,
        environment: Mapping[str, str] | None = None,
        choose: Callable[[int], int] | None = None,
        standard_input: Callable[[], bytes] | None = None,
    ) -> None:
        """Copy `environment` (default: that of this process). `choose(n)` returns a number below n for `$(anon)`.

        With `standard_input`, which is called once, the path `-` refers to its result.
        """
        self.environment: Mapping[str, str] = dict(os.environ if environment is None else environment)
        self._choose = choose or _choose_freely
        self._standard_input = standard_input
        self._was_read: bytes | None = None
        self._packages: dict[str, str] | None = None
        self._names: frozenset[str] | None = None
        self._workspaces: Workspaces | None = None

    def find_package(self, name: str) -> str:
        if self._packages is None:
            self._packages = find_packages(package_paths(self.environment))
        try:
            return self._packages[name]
        except KeyError:
            raise PackageNotFound(name) from None

    def package_names(self) -> Iterable[str]:
        if self._names is None:
            if self._packages is None:
                self._packages = find_packages(package_paths(self.environment))
            self._names = frozenset(self._packages)
        return self._names

    def find_in_package(self, package: str, path: str) -> str | None:
        """See World: as in roslaunch, an executable takes precedence over an installed file."""
        places = self._catkin().find(("lib", "libexec"), package)
        if places:
            candidate = os.path.join(places[0], os.path.basename(path))
            if os.path.isfile(candidate) and os.access(candidate, os.X_OK):
                return candidate
        candidate = os.path.join(self.find_package(package), path)
        if os.path.isfile(candidate) and os.access(candidate, os.X_OK):
            return candidate
        shared = self._catkin().find(("share",), package, path)
        return shared[0] if shared else None

    def find_files(self, package: str, name: str) -> tuple[str, ...]:
        return self._search(package, name, lambda _path: True)

    def find_executables(self, package: str, name: str) -> tuple[str, ...]:
        return self._search(package, name, _may_run)

    def executable_names(self, package: str) -> Iterable[str]:
        return {os.path.basename(path) for path in self._walk(package) if _may_run(path)}

    def is_file(self, path: str) -> bool:
        try:
            return os.path.isfile(path)
        except ValueError:
            return False

    def read_bytes(self, path: str) -> bytes:
        """See World. Only regular files are read: a pipe could block for ever."""
        if path == "-" and self._standard_input is not None:
            if self._was_read is None:
                self._was_read = self._standard_input()
            return self._was_read
        try:
            return read_file(path, MAX_READ)
        except ValueError as problem:  # a path with half a surrogate pair
            raise OSError(0, str(problem), path) from None

    def list_folder(self, path: str) -> tuple[str, ...]:
        try:
            return tuple(sorted(os.listdir(path or ".")))
        except (OSError, ValueError):
            return ()

    def absolute(self, path: str) -> str:
        return os.path.abspath(path)

    def make_anonymous(self, prefix: str) -> str:
        """See World. As in rosgraph, it consists of host, process and number; invalid characters become `_`."""
        name = f"{prefix}_{os.uname().nodename}_{os.getpid()}_{self._choose(sys.maxsize)}"
        return name.replace(".", "_").replace("-", "_").replace(":", "_")

    def _catkin(self) -> Workspaces:
        if self._workspaces is None:
            self._workspaces = Workspaces(self.environment)
        return self._workspaces

    def _search(self, package: str, name: str, accept: Callable[[str], bool]) -> tuple[str, ...]:
        paths = dict.fromkeys(os.path.abspath(path) for path in self._walk(package) if os.path.basename(path) == name)
        return tuple(path for path in paths if accept(path))

    def _walk(self, package: str) -> Iterator[str]:
        # Every file of a package, in the order of roslib.packages.find_resource.
        folder = self.find_package(package)
        for place in [*self._catkin().find(("lib", "libexec", "share"), package), folder]:
            for directory, folders, files in walk_links(place):
                yield from (os.path.join(directory, name) for name in files)
                for hidden in [name for name in folders if name.startswith(".")]:
                    folders.remove(hidden)


def _choose_freely(limit: int) -> int:
    return int.from_bytes(os.urandom(16), "little") % limit  # importing `random` costs as much as reading ten files


def _may_run(path: str) -> bool:
    try:
        return os.stat(path).st_mode & _OWNER_MAY_RUN == _OWNER_MAY_RUN
    except OSError:
        return False


class Workspaces:
    """The workspaces of an environment, most important first. Their source folders are read on demand."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        ros2 = environment.get("ROS_VERSION") in ("0", "2")  # or none
        variable = "AMENT_PREFIX_PATH" if ros2 else "CMAKE_PREFIX_PATH"
        prefixes = [path for path in environment.get(variable, "").split(os.pathsep) if path]
        if ros2:  # the user's bases do not depend on ROS
            self.folders = [*prefixes, *list_workspaces({**environment, "CMAKE_PREFIX_PATH": ""})]
        else:
            self.folders = [*(path for path in prefixes if os.path.isfile(os.path.join(path, MARKER))), "/usr"]
        self._sources: dict[str, list[str]] = {}
        self._packages: dict[str, dict[str, str]] = {}

    def find(self, kinds: tuple[str, ...], package: str, path: str | None = None) -> list[str]:
        """Return the existing folders of a package in the first workspace that has any.

        `kinds`: `lib`, `libexec`, `share`.
        """
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
