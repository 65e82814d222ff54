"""The stages of `ur launch`: load, join, place, debug, run. Each but the last returns the resulting plan.

The imports of a stage are inside it: most launches need few of them, and a start has to be fast.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ur.launchfile.plan.specs import Plan
from ur.request.launch_request import LaunchFiles, LaunchOptions, LaunchRequest, StartReporter, make_request
from ur.robot.selection import Selection
from ur.source.arguments import CommandLine, values_of
from ur.source.data_classes import dataclass, field, replace
from ur.source.diagnostic import Diagnostic, Note, Severity, UserError, error

if TYPE_CHECKING:
    from ur.launchfile.world.protocol import World
    from ur.request.plan_files import Inspect, LoadedPlan
    from ur.run.options import RunOptions
    from ur.run.output.console import Console
    from ur.run.process.host_client import ProcessHost
    from ur.run.record.registry import RunEntry
    from ur.run.supervisor.state import TimeLimits

_MADE = "xacro"  # no release of Debian has it, and many a robot_description calls it
_NO_PLAN = Plan((), (), (), (), (), ())


@dataclass(frozen=True, slots=True)
class Launch:
    """A launch in progress. `client` is the id of its run; `stack` is to be closed at its end.

    `make_xacro` builds the ROS package xacro. `offer` offers to install packages, by their names, and returns whether
    one was installed.
    """

    line: CommandLine
    selection: Selection
    options: LaunchOptions
    reporter: StartReporter
    stack: ExitStack
    make_xacro: Callable[[], None]
    offer: Callable[[Iterable[str]], bool]
    client: str = field(default_factory=lambda: os.urandom(8).hex())


@dataclass(frozen=True, slots=True)
class Staged:
    """The plan of a launch after a stage, in its world.

    `release` lets other launches at the same master continue. `environment` overrides that of the nodes, `owners` are
    the runs whose nodes this one uses, and `restart_share` has the robot start its nodes again. `end` replaces a run,
    and returns the exit code.
    """

    loaded: LoadedPlan
    plan: Plan
    world: World
    release: Callable[[], None]
    environment: Mapping[str, str] = field(default_factory=dict)
    owners: tuple[RunEntry, ...] = ()
    restart_share: Callable[[], str] | None = None
    end: Callable[[], int] | None = None


def prepare(launch: Launch) -> Staged:
    """Execute all stages before the run. Raises UserError, as the stages do."""
    staged = load(launch)
    for stage in (join, place, debug):
        if staged.end is None:
            staged = stage(launch, staged)
    return staged


def load(launch: Launch) -> Staged:
    """Load the plan, and install the requirements of its nodes. Errors in the files are printed, and end the launch.

    Raises UserError if the arguments do not suit the files, or a requirement cannot be installed.
    """
    from ur.request.joining.running import lock_launch, refuse_second_master
    from ur.request.requirements.preparation import prepare_world

    options = launch.options
    release = lock_launch(options, launch.stack, launch.reporter.report).release
    loaded = load_with_packages(launch)
    if loaded.plan is None:
        if options.report is not None:
            write_report(loaded.findings, options.report)
        return Staged(loaded, _NO_PLAN, loaded.world, release, end=lambda: 1)
    if options.core:
        refuse_second_master()
    paths = loaded.request.files.paths
    from ur.request.bases.localisation import explain_no_map

    try:
        world = prepare_world(paths, loaded.plan, loaded.world, launch.reporter.report, complete=options.part is None)
    except UserError as problem:
        raise explain_no_map(problem, values_of(loaded.arguments)) from None
    return Staged(loaded, loaded.plan, world, release)


def join(launch: Launch, staged: Staged) -> Staged:
    """Leave out running nodes, and claim the nodes of this run, unless it is a robot's share of a run.

    Raises UserError if all nodes are already running, or another client drives and there is no terminal.
    """
    if launch.options.part is not None:
        return staged
    from ur.request.joining import running as joining

    joined = joining.join(staged.loaded, launch.client, launch.reporter.report)
    if joined is None:  # the user does not want to go on
        return replace(staged, end=lambda: 0)
    if not launch.selection.simulated:
        from ur.run.remote.own_clients import clients_folder, hold_client

        launch.stack.enter_context(hold_client(launch.client, clients_folder(os.environ, os.getuid())))
    return replace(staged, plan=joined.plan, environment=joined.environment, owners=joined.owners)


def place(launch: Launch, staged: Staged) -> Staged:
    """Start the robot's nodes on the robot. Raises UserError if it cannot be reached, or cannot start them."""
    robot = staged.loaded.robot
    if not robot or not any(node.machine == robot for node in staged.plan.nodes):
        return staged
    from ur.request.remote.on_robot import start_there  # imported late: ssh and its modules, only if needed

    started = start_there(staged.loaded._replace(plan=staged.plan), launch.client, launch.reporter.report)
    part = launch.stack.enter_context(started)
    if part.here.nodes:
        return replace(staged, plan=part.here, restart_share=part.again.start)
    staged.release()
    return replace(staged, plan=part.here, end=part.follow)


def debug(launch: Launch, staged: Staged) -> Staged:
    """Run nodes under the debuggers that options request. Raises UserError for an unknown node or debugger."""
    options = launch.options
    if not options.debug:
        return staged
    from ur.request.debugging import debug_nodes, has_terminal

    terminal = not (options.detach or options.json) and has_terminal()
    plan, lines = debug_nodes(staged.plan, options.debug, staged.world, terminal=terminal)
    if lines:
        launch.reporter.report("warning", "\n".join(lines))
    return replace(staged, plan=plan)


def run(
    staged: Staged,
    host: ProcessHost,
    console: Console,
    viewer: socket.socket | None,
    call_started: Callable[[RunEntry], None] | None,
) -> int:
    """Run the plan to its end, and return the exit code. Raises UserError before anything is started.

    `viewer` is the connection of the interface; `call_started` is that of a detached run.
    """
    from ur.run.launch import run_plan

    options = replace(
        make_run_options(staged.loaded.request, call_started),
        environment=staged.environment,
        restart_share=staged.restart_share,
        owners=staged.owners,
        call_registered=staged.release,
        viewer=viewer,
    )
    return run_plan(staged.plan, staged.world, host, console, options)


class _ReadAgainError(Exception):
    """A package was installed before the errors that name it were printed, so that files have to be read again."""


def load_with_packages(launch: Launch) -> LoadedPlan:
    """Load what the command line names.

    Errors in its files are printed, except for a missing xacro, which is built. The installation of other missing
    packages is offered. Raises UserError, as `load_request` does, and if xacro cannot be built.
    """
    from ur.launchfile.plan.commands import run_with
    from ur.request.environment import apply_selection
    from ur.request.joining.running import follow_world
    from ur.request.plan_files import load_chosen, make_world

    def load(inspect: Inspect | None) -> LoadedPlan:
        request = make_request(launch.line, make_world(), launch.selection, launch.options, run_with)
        if launch.options.program:
            from ur.request.programs import refuse_undeclared

            refuse_undeclared(launch.options.program, request.arguments, request.files.declared)
        loaded = load_chosen(follow_world(request), launch.reporter.report, inspect)
        if loaded.plan is not None and loaded.plan.launcher != "roslaunch" and os.environ.get("ROS_VERSION") != "2":
            raise UserError(_explain_launcher(launch.line.argv, request.files))
        return loaded

    def make_xacro_first(findings: Iterable[Diagnostic]) -> None:
        if any(each.rule == "unknown-package" and each.subject == _MADE for each in findings):
            launch.make_xacro()
            raise _ReadAgainError

    try:
        loaded = load(make_xacro_first)
    except _ReadAgainError:
        apply_selection(launch.selection)  # its folder of packages may be new
        loaded = load(None)
    names = {each.subject for each in loaded.findings if each.rule == "unknown-package" and each.subject}
    once = "-" in launch.line.names  # standard input is read once
    if loaded.plan is None and names and not once and launch.offer(names):
        apply_selection(launch.selection)
        loaded = load(None)
    return loaded


def _explain_launcher(argv: tuple[str, ...], files: LaunchFiles) -> Diagnostic:
    message = f"{argv[0]}: this is a launch file for ROS 2, and ROS {os.environ.get('ROS_VERSION') or '1'} is selected"
    if os.environ.get("ROS_VERSION") == "0":
        message = f"{argv[0]}: this is a launch file for ROS 2, which is not installed on this computer"
    help_ = "ur use sim --ros 2, then start it again; 'ur launch --dry-run' shows what it starts"
    trees = (each for each in files.parsed.values() if each.source.path in files.paths)
    signs = tuple(Note(each.message, each.span) for tree in trees for each in tree.diagnostics[:1])
    return error(message, rule="wrong-ros-version", notes=signs, help=help_, subject=argv[0])


def write_report(diagnostics: Iterable[Diagnostic], path: str) -> None:
    """Write errors to a file, for the laptop that has requested this run."""
    import json

    errors = [
        {
            "message": each.message,
            "help": each.help or "",
            "rule": each.rule,
            "place": str(each.span) if each.span else "",
        }
        for each in diagnostics
        if each.severity is Severity.ERROR
    ]
    with suppress(OSError):
        Path(path).write_text(json.dumps(errors), encoding="utf-8")


def make_run_options(request: LaunchRequest, call_started: Callable[[RunEntry], None] | None = None) -> RunOptions:
    """Return the options of the run of a request. `call_started` is that of a detached run."""
    from ur.run.options import RunOptions

    options, selection, values = request.options, request.selection, request.values
    assert selection is not None
    base = values.get("robot_base", selection.base)
    # The arguments of rosmaster that options set
    found: list[str] = []
    if options.timeout is not None:
        found += ["-t", str(options.timeout)]
    if options.master_logger_level is not None:
        found += ["--master-logger-level", options.master_logger_level]
    return RunOptions(
        limits=make_limits(options),
        force_screen=options.screen,
        force_log=options.log,
        force_required=options.required,
        wait_for_master=options.wait and not options.detach,
        port=options.port,
        workers=options.numworkers,
        master_words=tuple(found),
        base=base,
        variant=values.get("robot_variant", selection.variant if base == selection.base else ""),
        events=1 if options.json else None,
        call_started=call_started,
    )


def make_limits(options: LaunchOptions) -> TimeLimits:
    """Return times and counts: those of `TimeLimits` unless options change them."""
    from ur.run.supervisor.state import TimeLimits

    defaults = TimeLimits()
    return TimeLimits(
        interrupt=options.sigint_timeout or defaults.interrupt,
        terminate=options.sigterm_timeout or defaults.terminate,
        failures_count=bool(options.program),
        quick_deaths=defaults.quick_deaths if options.respawn_limit is None else options.respawn_limit,
    )
