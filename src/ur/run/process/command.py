"""The command line of a node of a plan, argument for argument as in roslaunch.

Sources: roslaunch's `node_args.create_local_process_args`, `core.setup_env` and `nodeprocess.LocalProcess`.
"""

import os
import re
import shlex
from collections.abc import Sequence
from pathlib import Path

from ur.launchfile.plan.specs import NodeSpec, ReadyCondition
from ur.launchfile.world import PackageNotFound, World
from ur.run.supervisor.state import Unit
from ur.source.arguments import split_words
from ur.source.data_classes import dataclass, replace
from ur.source.diagnostic import Diagnostic, UserError, error
from ur.source.foreign.files import read_text
from ur.source.project import launch_library
from ur.source.suggest import did_you_mean, get_command
from ur.system.debian_root import install_command

_STARTS = re.compile(r'^exec .*/lib/node" (.+) "\$@"$', re.MULTILINE)
_OURS = {"UR_MAP_FILE"}  # variables of the environment that nodes read after their start
_LONGEST = 1 << 16  # characters of an executable
_OWN = "ubiquity_launches"
"""The package whose executables have the names of those that they stand in for."""


@dataclass(frozen=True, slots=True)
class UnitProgram:
    """A unit and its command.

    `changes` override the environment of the run, None removes a variable. `log_name` is the stem of its log files;
    `screen` whether its standard output is displayed; `ready` are its further readiness conditions. `executable` is the
    argument of `argv` that is the node's own program. `names_log`: it gets the path of its log as an argument, as nodes
    of ROS 1 do. `files` are texts by name, which are written into the folder of the run: `argv` has `PRIVATE` before
    these names. With None the middleware adds its arguments. `emulates_terminal`: its output goes to pseudo terminals.
    `module` is that of a node of this project, with its first arguments, which may be forked (`ur.run.host.forks`).
    """

    unit: Unit
    argv: tuple[str, ...]
    changes: tuple[tuple[str, str | None], ...] = ()
    cwd: str | None = None
    log_name: str = ""
    screen: bool = False
    ready: tuple[ReadyCondition, ...] = ()
    executable: str = ""
    names_log: bool = True
    files: tuple[tuple[str, str], ...] | None = None
    emulates_terminal: bool = False
    module: tuple[str, ...] = ()


PRIVATE = "\0/"
"""Stands for the folder of the run in arguments."""


def find_programs(nodes: Sequence[NodeSpec], world: World) -> tuple[tuple[UnitProgram, ...], tuple[Diagnostic, ...]]:
    """Return the program of each node, and an error for each that does not exist. Nothing is started.

    Log names are numbered from 1 in the order of the plan.
    """
    programs = []
    problems: list[Diagnostic] = []
    for number, node in enumerate(nodes, 1):
        try:
            programs.append(find_program(node, world, number))
        except UserError as problem:  # noqa: PERF203 - every node that is missing is to be named
            problems.extend(problem.diagnostics)
    return tuple(programs), tuple(problems)


def number_logs(programs: Sequence[UnitProgram], first: int) -> tuple[UnitProgram, ...]:
    """Return the same programs with log names numbered from `first`."""
    return tuple(
        replace(program, log_name=f"{program.log_name.rpartition('-')[0]}-{number}")
        for number, program in enumerate(programs, first)
    )


def find_program(node: NodeSpec, world: World, number: int) -> UnitProgram:
    """Find the program of a node.

    Raises UserError: no such package or executable, or arguments that cannot be split.
    """
    executable = find_executable(node, world)
    arguments = _split(node, "args", node.args)
    prefix = _split(node, "launch-prefix", node.launch_prefix or "")
    remaps = [f"{source}:={target}" for source, target in node.remaps]
    name = f"{node.full_name.lstrip('/')}-{number}"
    namespace = node.namespace.rstrip("/") or None
    return UnitProgram(
        unit=Unit(
            name=node.full_name,
            required=node.required,
            respawn=node.respawn,
            respawn_delay=node.respawn_delay,
            terminal=node.terminal,
        ),
        argv=(*prefix, executable, *arguments, *remaps, f"__name:={node.name}"),
        changes=(("ROS_NAMESPACE", namespace), *node.env),
        cwd=choose_folder(node.cwd, (*prefix, executable)[0]),
        log_name=name.replace("/", "-"),
        screen=node.output == "screen",
        ready=node.ready,
        executable=executable,
        module=() if prefix or node.terminal or not _OURS.issuperset(dict(node.env)) else _find_own_module(executable),
    )


def _find_own_module(executable: str) -> tuple[str, ...]:
    """Return what `read_module` does for an executable of this installation; () for all others."""
    words = read_module(executable) if executable.startswith(f"{launch_library()}/") else ()
    return words if words and words[0].startswith("ur_nodes.") else ()


def read_module(executable: str) -> tuple[str, ...]:
    """Return the module that an executable of this project runs, and its first arguments; () for other programs."""
    try:
        found = _STARTS.search(read_text(executable, _LONGEST))
    except (OSError, ValueError, UserError):
        return ()
    return tuple(found[1].split()) if found else ()


def find_executable(node: NodeSpec, world: World) -> str:
    """Return the path of a node's executable. Raises UserError that names the package, or its present executables."""
    try:
        found = world.find_executables(node.package, node.type)
    except PackageNotFound:
        if world.environment.get("ROS_VERSION") in ("0", "2"):
            return _find_own(node, world)
        near = did_you_mean(node.package, world.package_names())
        raise UserError(
            error(
                f"{node.full_name}: package {node.package!r} is not installed",
                node.origin.span,
                rule="unknown-package",
                help=f"did you mean {near!r}?" if near else describe_install(node.package),
            )
        ) from None
    except (OSError, ValueError) as problem:
        raise UserError(
            error(f"packages cannot be searched: {problem}", node.origin.span, rule="bad-package")
        ) from None
    if found:
        return found[0]
    files = world.find_files(node.package, node.type)
    if files:
        raise UserError(
            error(
                f"{node.full_name}: {files[0]} may not be executed",
                node.origin.span,
                rule="not-executable",
                help=f"chmod +x {shlex.quote(files[0])}",
            )
        )
    raise UserError(
        error(
            f"{node.full_name}: package {node.package!r} has no executable {node.type!r}",
            node.origin.span,
            rule="unknown-executable",
            help=f"it was searched for below {world.find_package(node.package)} and /usr/lib/{node.package}",
        )
    )


def _find_own(node: NodeSpec, world: World) -> str:
    """Return this project's executable of the same name, for a package that is not in this ROS 2. Raises UserError."""
    try:
        own = world.find_executables(_OWN, node.type)
    except (LookupError, OSError, ValueError):
        own = ()
    if own:
        return own[0]
    if world.environment.get("ROS_VERSION") == "0":
        raise UserError(
            error(
                f"{node.full_name}: package {node.package!r} is not part of this project, which nodes without ROS are",
                node.origin.span,
                rule="unknown-package",
                help=f"--except {node.full_name} leaves the node out; or use ROS 2 instead: ur use sim --ros 2",
                subject=node.package,
            )
        )
    distro = world.environment.get("ROS_DISTRO", "")
    debian = f"ros-{distro}-{node.package.replace('_', '-')}"
    raise UserError(
        error(
            f"{node.full_name}: package {node.package!r} is not installed for ROS 2 {distro.capitalize()}",
            node.origin.span,
            rule="unknown-package",
            help=f"sudo apt-get install {debian}, if it exists; --except {node.full_name} leaves the node out",
            subject=node.package,
        )
    )


def choose_folder(cwd: str | None, first_word: str) -> str | None:
    """Return the working directory that `cwd=` requests; None means ROS_HOME, the default."""
    if cwd == "node":
        return str(Path(first_word).parent)
    if cwd == "cwd":
        return os.getcwd()  # noqa: PTH109 - as roslaunch: the folder the user is in
    return None


def _split(node: NodeSpec, attribute: str, text: str) -> list[str]:
    try:
        return split_words(text)
    except ValueError as problem:
        raise UserError(
            error(
                f"{node.full_name}: {attribute}={text!r} cannot be split into words: {str(problem).lower()}",
                node.origin.span,
                rule="bad-arguments",
            )
        ) from None


OS_RELEASE = Path("/etc/os-release")
# Debian and Ubuntu split some ROS packages: one has the program, another one the package's manifest.
_NAMES = {
    "image_transport": "image-transport-tools libimage-transport-dev",
    "image_view": "ros-image-view libimage-view-dev",
    "joint_state_publisher": "joint-state-publisher",
    "rviz": "rviz",
    "topic_tools": "topic-tools libtopic-tools-dev",
}


def is_packaged(name: str, os_release: Path = OS_RELEASE) -> bool:
    """Return whether this computer's release has a Debian package; True if that is unknown."""
    from ur.system.releases import find_release, parse_os_release

    try:
        system = parse_os_release(os_release.read_text(encoding="utf-8", errors="replace"))
    except OSError:
        return True
    return name not in find_release(system).missing


def describe_install(package: str, os_release: Path = OS_RELEASE) -> str:
    """Describe the installation: a command if the Debian package is known and exists in this computer's release."""
    names = _NAMES.get(package)
    if names is not None and not is_packaged(names, os_release):
        return "this release does not package it; the terminal shows the map"
    if names is not None:
        return install_command(names)
    return f"{get_command(package)}, or add its folder to ROS_PACKAGE_PATH"
