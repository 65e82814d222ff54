"""What programs of the launch library need before they can run, made sure of before a run starts anything.

Their heads say it, below `##Summary:` and `##Overview:`:

    ##Python: vision.lock: cv2 gtsam: OpenCV and gtsam (110 MB)
    ##File: map_file: read_only_map: a map of fiducials: drive once with 'ur run fiducial_slam', which builds it

The first names a lock file, the modules that it holds and what people call them: where one is missing it is installed.
The second names a private parameter that is the path of a file, another that says whether it has to be there, what the
file is, and how to come by it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.cli.environment import PACKAGE
from ur.cli.on_demand import need_all
from ur.launchfile.plan.model import NodeSpec, Plan
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.source.diagnostic import UserError, error

_LOCAL = frozenset({"localhost", "127.0.0.1", "::1"})
_HEAD = 30  # lines
_PYTHON, _FILE = "##Python:", "##File:"
Install = Callable[[Sequence[str], str, str], None]


@dataclass(frozen=True, slots=True)
class PythonNeed:
    """Modules that a lock file of this project holds, and their names for people."""

    lock: str
    modules: tuple[str, ...]
    title: str


@dataclass(frozen=True, slots=True)
class FileNeed:
    """A file that the private parameter `path` names has to be there when the parameter `condition` is true."""

    path: str
    condition: str
    what: str
    help: str


def prepare(plan: Plan, world: World, install: Install = need_all, *, library: Path = PACKAGE) -> None:
    """Install what the plan's programs on this computer lack. Raises UserError: that failed, or a file is missing.

    Only programs of the launch library are looked at.
    """
    parameters = {each.name: each.value for each in plan.params}
    wanted: dict[str, PythonNeed] = {}
    for node, executable in _local_programs(plan, world, library):
        for need in read_needs(executable):
            if isinstance(need, PythonNeed):
                known = wanted.get(need.lock)
                modules = tuple(dict.fromkeys((*(known.modules if known else ()), *need.modules)))
                longest = max((need.title, known.title if known else ""), key=len)
                wanted[need.lock] = PythonNeed(need.lock, modules, longest)
            elif parameters.get(f"{node.full_name}/{need.condition}") is True:
                _check_file(node, str(parameters.get(f"{node.full_name}/{need.path}", "")), need)
    for each in wanted.values():
        install(each.modules, each.lock, each.title)


def read_needs(program: Path) -> tuple[PythonNeed | FileNeed, ...]:
    """What a program's head names; nothing where it cannot be read. Raises ValueError for a line with too few parts."""
    try:
        with program.open(encoding="utf-8", errors="replace") as file:
            lines = [line.strip() for line, _ in zip(file, range(_HEAD), strict=False)]
    except OSError:
        return ()
    needs: list[PythonNeed | FileNeed] = []
    for line in lines:
        if line.startswith(_PYTHON):
            lock, modules, title = (part.strip() for part in line.removeprefix(_PYTHON).split(":", 2))
            needs.append(PythonNeed(lock, tuple(modules.split()), title))
        elif line.startswith(_FILE):
            path, condition, what, how = (part.strip() for part in line.removeprefix(_FILE).split(":", 3))
            needs.append(FileNeed(path, condition, what, how))
    return tuple(needs)


def _local_programs(plan: Plan, world: World, library: Path) -> Iterator[tuple[NodeSpec, Path]]:
    addresses = {machine.name: machine.address for machine in plan.machines}
    for node in plan.nodes:
        local = node.machine is None or addresses.get(node.machine) in _LOCAL
        if node.package != library.name or not local:
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
