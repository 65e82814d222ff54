"""The request of a command line with launch files, made once, at the start of its verb."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

from ur.launchfile.address import resolve_addresses
from ur.launchfile.load import is_for_ros2, load_plan
from ur.launchfile.syntax import LaunchFile
from ur.launchfile.syntax.parse import parse_launch_file
from ur.launchfile.world.protocol import World
from ur.robot.selection import Selection
from ur.source.arguments import Argument, CommandLine, values_of
from ur.source.diagnostic import UserError, user_error
from ur.source.suggest import did_you_mean

if TYPE_CHECKING:
    from ur.launchfile.plan.commands import RunWith
    from ur.launchfile.plan.specs import MachineSpec, Plan
    from ur.run.clients.protocol import Severity
    from ur.run.remote.lease import Mode

Report = Callable[["Severity", str], None]
Query = tuple[str, str | None]
_PRECEDENCE = (
    "args",
    "find-node",
    "dump-params",
    "files",
    "ros-args",
    "nodes",
    "dry-run",
    "dump",
)  # as roslaunch's main
_OURS = {"dry-run", "dump"}
_EXCLUSIVE = {"nodes", "find-node", "args", "ros-args"}


class LaunchOptions(NamedTuple):
    """The options of a command line."""

    core: bool = False
    local: bool = False
    part: str | None = None  # only the nodes of this machine, which is this computer
    runs_already: Sequence[str] = ()  # nodes of that part that are not to be started again
    verbose: bool = False
    screen: bool = False
    log: bool = False
    required: bool = False
    wait: bool = False
    port: int | None = None
    numworkers: int | None = None
    timeout: float | None = None
    master_logger_level: str | None = None
    pid: str | None = None
    sigint_timeout: float | None = None
    sigterm_timeout: float | None = None
    only: Sequence[str] = ()
    except_: Sequence[str] = ()
    no_terminal: bool = False
    prefix: Sequence[str] = ()
    debug: Sequence[str] = ()
    detach: bool = False
    plain: bool = False
    calm: bool = False
    json: bool = False
    timeout_ready: float = 30.0
    respawn_limit: int | None = None
    watch: bool = False  # these three: the conduct where another client drives the robot
    ask: bool = False
    take_over: bool = False
    unattended: bool = False
    replace: bool = False
    report: str | None = None  # a file for errors before the start, as JSON
    queries: Sequence[Query] = ()
    with_origins: bool = False  # these two: of --dump
    no_commands: bool = False
    # Of `ur run` and `ur replay`: arguments that it does not declare are refused, and a failed required node counts.
    program: str = ""

    @property
    def mode(self) -> Mode:
        """The mode that the options set for a robot that another client drives."""
        return "watch" if self.watch else "ask" if self.ask else "take" if self.take_over else "drive"


class StartReporter:
    """Prints lines before the start, and stores them for the log of the run's interface."""

    def __init__(self) -> None:
        self.notices: list[tuple[Severity, str]] = []

    def report(self, severity: Severity, text: str) -> None:
        """Print a line on standard error."""
        self.notices.append((severity, text))
        sys.stderr.write(f"{text}\n")


def choose_query(queries: Sequence[Query]) -> Query | None:
    """Return the query that is answered, since roslaunch accepts several; None without one."""
    return min(queries, key=lambda query: _PRECEDENCE.index(query[0]), default=None)


def check_options(names: Sequence[str], options: LaunchOptions) -> None:
    """Raise UserError for options and arguments that exclude each other."""
    if options.core and (names or options.wait or options.queries):
        raise user_error(
            "--core starts a master alone, expected no launch file, --wait or question", rule="bad-options"
        )
    if names.count("-") > 1:
        raise user_error("'-' is standard input, expected it once", rule="bad-options")
    if options.screen and options.log:
        raise user_error("--screen and --log cannot be used together", rule="bad-options")
    modes = [name for name in ("watch", "ask", "take_over") if getattr(options, name)]
    if len(modes) > 1:
        text = " and ".join(f"--{name.replace('_', '-')}" for name in modes)
        raise user_error(f"{text} cannot be used together", rule="bad-options")
    if options.detach and options.json:
        help_ = "'ur attach --json' prints the events of a run that is detached"
        raise user_error("--detach and --json cannot be used together", rule="bad-options", help=help_)
    if (options.with_origins or options.no_commands) and not any(name == "dump" for name, _ in options.queries):
        raise user_error("--with-origins and --no-commands belong to --dump json", rule="bad-options")
    _check_seconds(options)
    names = [name for name, _ in options.queries]
    if len([name for name in names if name in _EXCLUSIVE]) > 1 or (len(names) > 1 and set(names) & _OURS):
        raise user_error(f"{' and '.join(f'--{name}' for name in names)} cannot be used together", rule="bad-options")


def _check_seconds(options: LaunchOptions) -> None:
    """Raise UserError for times that are not valid numbers."""
    for name in ("timeout", "sigint_timeout", "sigterm_timeout", "timeout_ready"):
        value = getattr(options, name)
        if value is not None and value != value:
            option = name.replace("_", "-")
            raise user_error(
                f"--{option} nan, expected a number of seconds above 0", rule="bad-options", subject=option
            )


_PLAIN = re.compile(r"[\w./+-]+")


def suggest_assignment(text: str, declared: Sequence[str], following: str = "") -> str:
    """Return a misspelt argument in the form `NAME:=VALUE`, '' if no argument of the launch file is similar.

    `declared` are the names of the arguments. The value is the text after `=`, else `following`, else dots. A text
    without a name is taken as the value of an argument that has such values: a world, a map, a base.
    """
    bare, assigned, value = text.lstrip("-").partition("=")
    owner = "" if assigned or text.startswith("-") else _owner(bare, declared)
    if owner:
        return f"{owner}:={bare}"
    name = did_you_mean(bare.replace("-", "_"), declared)
    return write_assignment(name, value or following) if name else ""


def write_assignment(name: str, value: str) -> str:
    """Return `NAME:=VALUE`, with dots for a value that is empty or unsafe for a shell or a terminal."""
    return f"{name}:={value if _PLAIN.fullmatch(value) else '...'}"


def _owner(word: str, declared: Sequence[str]) -> str:
    return next((name for name, values in _known_values() if name in declared and word in values), "")


def _known_values() -> Iterator[tuple[str, Sequence[str]]]:
    from ur.maps.store import own_store
    from ur.robot.base import list_bases
    from ur.source.project import launch_library
    from ur.worlds.choice import WORLD, list_worlds

    yield WORLD, list_worlds(launch_library())
    yield "robot_base", list_bases(launch_library())
    yield "map", own_store(os.environ).names()


STANDARD_INPUT = "-"


NO_OPTIONS = LaunchOptions()


class LaunchFiles:
    """The launch files of a request, in a world. Each file and include is read and parsed only once.

    `parsed` has the trees by the paths that name them; `load_plan` uses and extends it. `arguments` are those given,
    and `run` is that of `load_plan`.
    """

    def __init__(
        self, paths: Sequence[str], world: World, arguments: Iterable[Argument] = (), run: RunWith | None = None
    ) -> None:
        self.paths = tuple(paths)
        self.world = world
        self._given = tuple(map(str, arguments))
        self._run = run
        self._plans: dict[tuple[str, ...], Plan] = {}  # of files for ROS 2, by file and arguments
        self.parsed: dict[str, LaunchFile] = {}
        self._declared: tuple[str, ...] | None = None

    def parse(self, path: str) -> LaunchFile:
        """Parse a file, unless it was parsed before. Raises OSError."""
        known = self.parsed.get(path)
        if known is None:
            read = self.world.read_bytes
            known = self.parsed[path] = parse_launch_file(path, read(path), read)
        return known

    def load(self, arguments: Sequence[str], computers: Sequence[MachineSpec] = ()) -> Plan:
        """Return the plan with `NAME:=VALUE` arguments. See `load_plan`."""
        known = self._plans.get((*self.paths, *arguments))
        return known or load_plan(
            self.paths, arguments, self.world, computers=computers, parsed=self.parsed, run=self._run
        )

    @property
    def declared(self) -> tuple[str, ...]:
        """Return the arguments that the files declare and that can be given, in order.

        Unreadable files declare none.
        """
        if self._declared is None:
            names: dict[str, None] = {}
            for path in self.paths:
                if is_for_ros2(path, self.world, parsed=self.parsed):
                    plan = load_plan([path], self._given, self.world, parsed=self.parsed, run=self._run)
                    self._plans.update({(path, *self._given): plan})  # which most requests need as it is
                    names.update(dict.fromkeys(plan.declared))
                    continue
                try:
                    parsed = self.parse(path)
                except OSError:
                    continue
                for element in parsed.launch.elements if parsed.launch is not None else ():
                    if element.name == "arg" and "value" not in element.attributes:
                        names[element.attributes.get("name", "")] = None
            self._declared = tuple(names)
        return self._declared


class LaunchRequest(NamedTuple):
    """Launch files with their given arguments, the selected robot, and options.

    Without a `selection` the arguments are complete. `names` are the names of the command line as typed.
    """

    files: LaunchFiles
    arguments: tuple[Argument, ...] = ()
    selection: Selection | None = None
    options: LaunchOptions = NO_OPTIONS
    names: tuple[str, ...] = ()

    @property
    def values(self) -> dict[str, str]:
        """Return the values of the arguments by name."""
        return values_of(self.arguments)

    @property
    def argv(self) -> tuple[str, ...]:
        """Return the names and arguments as a command line, without options."""
        return (*self.names, *map(str, self.arguments))

    def add_arguments(self, added: Iterable[Argument]) -> LaunchRequest:
        """Return a request with more arguments."""
        return self._replace(arguments=(*self.arguments, *added))


def make_request(
    line: CommandLine,
    world: World,
    selection: Selection | None = None,
    options: LaunchOptions = NO_OPTIONS,
    run: RunWith | None = None,
) -> LaunchRequest:
    """Make a request of `FILE` or `PACKAGE FILE`, and `[ARG:=VALUE]...`. `run` is that of `load_plan`.

    Raises UserError for a missing file, or a name that is neither a file nor an argument.
    """
    files = LaunchFiles(resolve_addresses(line.names, world), world, line.arguments, run)
    refuse_stray_names(files)
    return LaunchRequest(files, line.arguments, selection, options, line.names)


def follow_file(line: CommandLine, selection: Selection, report: Report) -> Selection:
    """Return the selection for a launch file: with ROS 2 for one of ROS 2 that is installed. A chosen version stays."""
    from ur.launchfile.world.system import SystemWorld
    from ur.request.environment import choose_ros, environment_changes

    if selection.ros or not line.names or STANDARD_INPUT in line.names:
        return selection
    present, chosen = choose_ros(selection, os.environ), selection._replace(ros="2")
    other = choose_ros(chosen, os.environ)
    if present is None or present.version == 2 or other is None:
        return selection
    for each in (selection, chosen):
        world = SystemWorld({**os.environ, **environment_changes(each, os.environ)})
        try:
            paths = resolve_addresses(line.names, world)
        except UserError:  # only the other one may have the package
            continue
        if len(paths) != 1 or not is_for_ros2(paths[0], world):
            return selection
        report("info", f"{' '.join(line.names)} is a launch file for ROS 2: using {other}, not {present}")
        return chosen
    return selection


def refuse_stray_names(files: LaunchFiles) -> None:
    """Raise UserError for a name after the launch file that is neither another file nor NAME:=VALUE."""
    for name in files.paths[1:]:
        if name == STANDARD_INPUT or files.world.is_file(name):
            continue
        declared = files.declared
        near = suggest_assignment(name, declared)
        known = f", expected NAME:=VALUE with NAME one of {', '.join(declared)}"
        if not declared:
            known = ": the launch file declares no arguments"
        raise user_error(
            f"{name!r} is not an argument{known}",
            rule="bad-argument",
            help=f"did you mean {near}?" if near else None if declared else f"leave {name} out",
            subject=name,
        )
