"""Requirements of the launch library's programs, satisfied before a run starts anything.

Their heads name them, below `##Summary:` and `##Overview:`:

    ##Python: vision.lock: cv2 gtsam: OpenCV and gtsam (110 MB)
    ##Debian: camera_needed: libegl1 libgl1-mesa-dri | libosmesa6: OpenGL for the simulated camera (41 MB)
    ##File: map_file: read_only_map: a map of fiducials: drive once with 'ur run fiducial_slam', which builds it
    ##Package: nav2: nav2_msgs: no goal can be sent to Nav2: install Nav2

The first names a lock file, the modules that it holds and what people call them: where one is missing it is installed.
The second names a private parameter that says whether the Debian packages are needed, alternative sets of packages, and
what people call them: where no set is complete the first is installed.
The third names a private parameter that is the path of a file, another that says whether it has to be there, what the
file is, and how to come by it.
The fourth names a private parameter that says whether a ROS package is needed, the package, what cannot be done without
it, and what to do: where it is missing, a line says so, and all starts.
RViz is installed likewise where a node of the plan needs it and there is a display; only a view insists on it.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.request.environment import PACKAGE
from ur.request.launch_request import Report
from ur.request.programs import read_head_lines
from ur.request.requirements.debian_packages import install_debian
from ur.request.requirements.python_packages import need_all
from ur.run.process.command import is_packaged
from ur.run.startup.node_selection import check_display, has_display, is_view
from ur.source.diagnostic import UserError, error

_PYTHON, _DEBIAN, _FILE, _PACKAGE = "##Python:", "##Debian:", "##File:", "##Package:"
_RVIZ = "RViz (77 MB to download)"
Install = Callable[[Sequence[str], str, str], None]


class InstallDebian(Protocol):
    """The interface of `install_debian`."""

    def __call__(self, alternatives: Sequence[Sequence[str]], title: str, *, ask: bool = True) -> None:
        """Install Debian packages."""


@dataclass(frozen=True, slots=True)
class PythonNeed:
    """Modules that a lock file of this project contains, and their description for the user."""

    lock: str
    modules: tuple[str, ...]
    title: str


@dataclass(frozen=True, slots=True)
class DebianNeed:
    """Alternative sets of Debian packages that are needed if the private parameter `condition` is true."""

    condition: str
    alternatives: tuple[tuple[str, ...], ...]
    title: str


@dataclass(frozen=True, slots=True)
class FileNeed:
    """A file, named by the private parameter `path`, that must exist if the parameter `condition` is true."""

    path: str
    condition: str
    what: str
    help: str


@dataclass(frozen=True, slots=True)
class PackageNeed:
    """A ROS package without which something cannot be done when the private parameter `condition` is true."""

    condition: str
    package: str
    lost: str
    help: str


Need = PythonNeed | DebianNeed | FileNeed | PackageNeed


def prepare(
    plan: Plan,
    world: World,
    install: Install = need_all,
    install_packages: InstallDebian = install_debian,
    *,
    library: Path = PACKAGE,
    view: bool = False,
) -> bool:
    """Install the missing requirements of the plan's programs on this computer; return whether RViz was installed.

    Only programs of the launch library, and RViz, are considered. Without RViz a `view` cannot start; other programs
    start nevertheless, so no password is asked for then. Raises UserError if that fails, or a file is missing.
    """
    parameters = {each.name: each.value for each in plan.params}
    wanted: dict[str, PythonNeed] = {}
    packages: dict[tuple[tuple[str, ...], ...], str] = {}
    for node, executable in _local_programs(plan, world, library):
        for need in read_needs(executable):
            if isinstance(need, PythonNeed):
                known = wanted.get(need.lock)
                modules = tuple(dict.fromkeys((*(known.modules if known else ()), *need.modules)))
                longest = max((need.title, known.title if known else ""), key=len)
                wanted[need.lock] = PythonNeed(need.lock, modules, longest)
            elif parameters.get(f"{node.full_name}/{need.condition}") is not True:
                continue
            elif isinstance(need, DebianNeed):
                packages[need.alternatives] = need.title
            elif isinstance(need, FileNeed):
                _check_file(node, str(parameters.get(f"{node.full_name}/{need.path}", "")), need)
    for each in wanted.values():
        install(each.modules, each.lock, each.title)
    for alternatives, title in packages.items():
        install_packages(alternatives, title)
    if not needs_rviz(plan, world) or not is_packaged("rviz"):
        return False  # where the release has none, the run reports that RViz is left out
    try:
        install_packages([["rviz"]], _RVIZ, ask=view)
    except UserError:
        if view:
            raise
        return False  # the run reports that RViz is left out, and how to install it
    return True


def prepare_world(files: Sequence[str], plan: Plan, world: World, report: Report, *, complete: bool) -> World:
    """Install the requirements of the plan, and return a world that includes them. Raises UserError.

    Missing ROS packages are reported.

    `complete`: the plan has the nodes of every computer, and may need a display.
    """
    from ur.launchfile.world.system import SystemWorld

    for text in name_missing(plan, world):
        report("warning", text)

    if complete:
        check_display(files, plan.nodes, world.environment)
    return SystemWorld(world.environment) if prepare(plan, world, view=is_view(files)) else world


def name_missing(plan: Plan, world: World, library: Path = PACKAGE) -> list[str]:
    """Name the ROS packages that programs of the plan lack, with what cannot be done without them."""
    parameters = {each.name: each.value for each in plan.params}
    lines = []
    for node, executable in _local_programs(plan, world, library):
        for need in read_needs(executable):
            wanted = isinstance(need, PackageNeed) and parameters.get(f"{node.full_name}/{need.condition}") is True
            if isinstance(need, PackageNeed) and wanted and not _is_installed(need.package, world):
                line = f"warning: {node.full_name}: package '{need.package}' is not installed: {need.lost}"
                lines.append(f"{line}\n  help: {need.help}")
    return lines


def _is_installed(package: str, world: World) -> bool:
    try:
        world.find_package(package)
    except PackageNotFound:
        return False
    return True


def needs_rviz(plan: Plan, world: World) -> bool:
    """Return whether the plan has a node of RViz for this computer, which has a display and no RViz."""
    if not has_display(world.environment) or not any(
        node.package == "rviz" for node in filter(plan.is_local, plan.nodes)
    ):
        return False
    return not _is_installed("rviz", world)


def read_needs(program: Path) -> tuple[Need, ...]:
    """Read the requirements in a program's head; empty if it cannot be read.

    Raises ValueError for an incomplete line.
    """
    try:
        lines = [line.strip() for line in read_head_lines(program)]
    except OSError:
        return ()
    needs: list[Need] = []
    for line in lines:
        if line.startswith(_PYTHON):
            lock, modules, title = (part.strip() for part in line.removeprefix(_PYTHON).split(":", 2))
            needs.append(PythonNeed(lock, tuple(modules.split()), title))
        elif line.startswith(_DEBIAN):
            condition, names, title = (part.strip() for part in line.removeprefix(_DEBIAN).split(":", 2))
            needs.append(DebianNeed(condition, tuple(tuple(each.split()) for each in names.split("|")), title))
        elif line.startswith(_FILE):
            path, condition, what, how = (part.strip() for part in line.removeprefix(_FILE).split(":", 3))
            needs.append(FileNeed(path, condition, what, how))
        elif line.startswith(_PACKAGE):
            condition, package, lost, how = (part.strip() for part in line.removeprefix(_PACKAGE).split(":", 3))
            needs.append(PackageNeed(condition, package, lost, how))
    return tuple(needs)


def _local_programs(plan: Plan, world: World, library: Path) -> Iterator[tuple[NodeSpec, Path]]:
    for node in filter(plan.is_local, plan.nodes):
        if node.package != library.name:
            continue
        try:
            found = world.find_executables(node.package, node.type)
        except PackageNotFound:
            continue
        yield from ((node, Path(path)) for path in found[:1])


def _check_file(node: NodeSpec, path: str, need: FileNeed) -> None:
    if path and not Path(path).expanduser().is_file():
        message = f"{node.full_name}: {path} is not there, expected {need.what}"
        raise UserError(error(message, rule="no-file", help=need.help))
