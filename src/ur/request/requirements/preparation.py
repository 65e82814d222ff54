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

import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Protocol

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.request.launch_request import Report
from ur.request.programs import PACKAGE, read_head_lines
from ur.request.requirements.python_packages import DiskFullError, need_all, run_installer
from ur.run.process.command import is_packaged
from ur.run.startup.node_selection import check_display, has_display, is_view
from ur.source.data_classes import dataclass
from ur.source.diagnostic import UserError, user_error
from ur.system.debian_root import DebianRoot, find_root, install_command

_APT = ("apt-get", "-q", "-o", "DPkg::Lock::Timeout=300")


@dataclass(frozen=True, slots=True)
class Account:
    """The account that requests packages: its user id, the program sudo, and the Debian root that it is in."""

    uid: Callable[[], int] = os.geteuid
    sudo: Callable[[], str | None] = lambda: _find_program("sudo")
    root: Callable[[Mapping[str, str]], DebianRoot | None] = find_root


_ACCOUNT = Account()


def _find_program(name: str) -> str | None:
    import shutil  # only where a program needs packages

    return shutil.which(name)


def install_debian(
    alternatives: Sequence[Sequence[str]], title: str, *, ask: bool = True, account: Account = _ACCOUNT
) -> None:
    """Install the first set of Debian packages unless one of the sets is installed already.

    `title` describes the installation for the user. With `ask` sudo may ask for a password on the terminal. A system
    without dpkg is not changed. Raises UserError if the packages cannot be installed, or the user may not.
    """
    if _find_program("dpkg-query") is None or any(not list_missing(names) for names in alternatives):
        return
    missing = list_missing(alternatives[0])
    command = "apt-get install " + " ".join(missing)
    root = _root_prefix(missing, command, ask=ask, account=account)
    sys.stderr.write(f"installing {title}: Debian packages {' '.join(missing)}, once ...\n")
    install = [*root, *_APT, "install", "-y", "--no-install-recommends", *missing]
    settings = f"apt's sources, or try it by hand: sudo {command}"
    try:
        run_installer(install, " ".join(missing), settings)
    except DiskFullError:  # new package lists need room, too
        raise
    except UserError:  # the package lists may be old, or missing
        sys.stderr.write("fetching new package lists ...\n")
        run_installer([*root, *_APT, "update"], "new package lists", settings)
        run_installer(install, " ".join(missing), settings)


def list_missing(names: Sequence[str]) -> list[str]:
    """Return the Debian packages, of these, that are not installed."""
    import subprocess  # only where a program needs packages

    query = ["dpkg-query", "--show", "--showformat=${Package} ${db:Status-Status}\n", *names]
    done = subprocess.run(query, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    installed = {line.removesuffix(" installed") for line in done.stdout.splitlines() if line.endswith(" installed")}
    return [name for name in names if name not in installed]


def _root_prefix(missing: Sequence[str], command: str, *, ask: bool, account: Account = _ACCOUNT) -> list[str]:
    """Return the arguments in front of a command that needs root. Raises UserError if the user cannot become root."""
    import subprocess

    if account.root(os.environ) is not None:
        raise _refusal(missing, "this Debian root is changed from outside only", install_command(missing))
    environment = ["env", "DEBIAN_FRONTEND=noninteractive"]
    if account.uid() == 0:
        return environment
    sudo = account.sudo()
    if sudo is None:
        raise _refusal(missing, "sudo is not installed", f"as root: {command}")
    if subprocess.run([sudo, "-n", "true"], stdin=subprocess.DEVNULL, capture_output=True, check=False).returncode:
        if not ask or not sys.stdin.isatty():
            raise _refusal(missing, "sudo asks for a password and there is no terminal", f"sudo {command}")
        sys.stderr.write(f"Debian packages are missing ({' '.join(missing)}): sudo asks for your password\n")
        if subprocess.run([sudo, "-v"], check=False).returncode:
            raise _refusal(missing, "sudo was refused", f"ask an administrator to run: {command}")
    return [sudo, *environment]


def _refusal(missing: Sequence[str], reason: str, help_: str) -> UserError:
    message = f"Debian packages {' '.join(missing)} are missing and could not be installed: {reason}"
    return user_error(message, rule="no-package", help=help_)


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
        raise user_error(f"{node.full_name}: {path} is not there, expected {need.what}", rule="no-file", help=need.help)
