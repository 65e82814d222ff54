"""Start of a plan: leave out nodes, find programs, find or start the master, and enter the loop."""

from __future__ import annotations

import os
import socket
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.world import World
from ur.recordings.black_boxes import notify_black_boxes
from ur.run.loop import run_loop
from ur.run.master.parameters import check_sendable, start_commands
from ur.run.middleware.protocol import Middleware
from ur.run.options import RunOptions
from ur.run.output.console import Console
from ur.run.output.log_rotation import read_bounds
from ur.run.paths import make_home, make_run_folder, new_run_id
from ur.run.process.command import UnitProgram, find_programs, number_logs
from ur.run.process.host_client import HostLost, ProcessHost
from ur.run.process.terminal import find_terminal, ignore_background_write
from ur.run.record.registry import RunEntry, make_run_name, read_computer, register_run, runs_folders, unregister_run
from ur.run.run import Run, RunClients
from ur.run.startup.node_selection import find_remote, find_terminals, force_options, leave_out_viewers
from ur.run.supervisor.events import Event, SetupFailed, ShareFailed, ShareStarted
from ur.run.supervisor.state import Planned
from ur.source.diagnostic import Diagnostic, UserError, user_error
from ur.source.project import launch_library
from ur.source.run_users import FOLDER_VARIABLE, list_users, note_user, read_birth

if TYPE_CHECKING:
    from ur.run.clients.protocol import RunStarted

__all__ = ["RunOptions", "run_plan"]


def run_plan(plan: Plan, world: World, host: ProcessHost, console: Console, options: RunOptions) -> int:
    """Run a plan without errors to its end and return the exit code.

    Raises UserError before anything is started, for a missing executable, a node for another computer, an invalid
    parameter value, no master on the selected robot, no folder for log files, or an invalid limit of their size.
    """
    environment = {**world.environment, **options.environment}
    bounds, home = read_bounds(environment), make_home(environment)
    nodes, programs = _find_nodes(plan, world, console, options)
    steps, planned = _plan_effects(plan, nodes, world)
    middleware = find_middleware(plan, environment, world, options, console)
    environment |= middleware.environment
    folder = make_run_folder(environment, middleware.run_id or new_run_id())
    arranged = middleware.arrange(number_logs(programs, middleware.logs), nodes, folder)
    programs, planned = _place_effects(arranged, steps, planned, plan, folder)
    commands = start_commands(plan.params, environment)
    if not programs and not middleware.core and not planned:
        done = middleware.set_parameters(plan, folder, options, commands)
        if isinstance(done, SetupFailed):
            raise user_error(done.reason, rule="setup-failed")
        console.inform("parameters are set; there is no node to start")
        console.finish(1.0)
        return 0
    try:
        detached = options.call_started is not None
        entry, listener = register(plan, middleware.address, folder, environment, console, detached=detached)
        claim(entry, nodes, plan, options)
        _begin(host, environment, entry, fork_command(programs, environment, entry.folder), nodes)
        terminal = None if detached else find_terminal()
        ignore_background_write()
        console.inform(middleware.describe())
        console.inform(f"{len(nodes)} node{'' if len(nodes) == 1 else 's'}, log files in {folder}")
        if not nodes:
            console.warn("there is no node to start; the master runs until Ctrl-C")
        run = Run(
            programs=(*middleware.core, *programs),
            folder=folder,
            home=home,
            own_master=bool(middleware.core),
            await_master=lambda: middleware.await_core(options.limits.master),
            set_parameters=lambda: middleware.set_parameters(plan, folder, options, commands),
            unregister=lambda: middleware.unregister([node.full_name for node in nodes]),
            limits=options.limits,
            log_name=entry.run,
            log_bounds=bounds,
            restart_share=_report_share(options),
            middleware=middleware,
            simulated_time=any(param.name == "/use_sim_time" and param.value is True for param in plan.params),
            clients=plan_clients((entry, listener), nodes, options, environment),
            owners=options.owners,
            planned=planned,
            list_joined=lambda: list_joined_runs(entry),
        )
        try:
            return run_loop(run, host, console, terminal)
        finally:
            unregister_run(entry)
    finally:
        commands.stop()


def fork_command(programs: Sequence[UnitProgram], environment: Mapping[str, str], folder: str) -> tuple[str, ...]:
    """Return the command of the process that forks nodes of this project; () for fewer than two, or with a debugger."""
    modules = [program.module[0] for program in programs if program.module]
    if len(modules) < 2 or environment.get("UR_NODE_PYTHON_OPTIONS"):
        return ()
    return (str(launch_library() / "lib/node"), "ur_nodes.fork_server", folder, *dict.fromkeys(modules))


def _begin(
    host: ProcessHost, environment: dict[str, str], entry: RunEntry, server: tuple[str, ...], nodes: Sequence[NodeSpec]
) -> None:
    keep_terminal = any(node.terminal for node in nodes)
    if keep_terminal:  # it shows the robot's other users; other programs get the environment of roslaunch
        environment[FOLDER_VARIABLE] = entry.folder
    try:
        host.begin(environment, keep_terminal=keep_terminal, server=server)
    except HostLost:
        unregister_run(entry)
        message = "the process host was killed before anything was started"
        raise user_error(message, rule="no-process-host", help="start it once more") from None


def _find_nodes(
    plan: Plan, world: World, console: Console, options: RunOptions
) -> tuple[tuple[NodeSpec, ...], tuple[UnitProgram, ...]]:
    """Return the nodes that run, and their programs. Raises UserError with all errors at once."""
    shown, notes = leave_out_viewers(plan.nodes, world, world.environment)
    for note in notes:
        console.warn(note)
    nodes = tuple(force_options(node, options) for node in shown if node.kind != "component")
    programs, missing = _find_programs(plan, nodes, world)
    problems = [*find_remote(plan, nodes), *missing]
    if problems:
        raise UserError(*problems)
    if plan.launcher == "roslaunch":
        check_sendable(plan.params)
    problems = find_terminals(nodes, detached=options.call_started is not None)
    if problems:
        raise UserError(*problems)
    return nodes, programs


def _find_programs(
    plan: Plan, nodes: Sequence[NodeSpec], world: World
) -> tuple[tuple[UnitProgram, ...], tuple[Diagnostic, ...]]:
    if plan.launcher == "roslaunch":
        return find_programs(nodes, world)
    from ur.run.process.described import describe_programs, refuse_gaps

    refuse_gaps(plan)
    return describe_programs(plan, nodes, world)


def _plan_effects(
    plan: Plan, nodes: Sequence[NodeSpec], world: World
) -> tuple[tuple[UnitProgram, ...], tuple[Planned, ...]]:
    """Return the programs that call services of nodes, and what events cause."""
    if not plan.actions and not any(node.trigger or node.kind == "component" for node in plan.nodes):
        return (), ()
    from ur.launchfile.plan.written import WrittenFiles
    from ur.run.process.described import add_written, plan_effects
    from ur.run.process.steps import describe_steps

    steps, awaited = describe_steps(plan, world)
    written = WrittenFiles(plan.written)
    return tuple(add_written(each, written) for each, _, _ in steps), plan_effects(plan, nodes, steps, awaited)


def _place_effects(
    programs: tuple[UnitProgram, ...],
    steps: Sequence[UnitProgram],
    planned: tuple[Planned, ...],
    plan: Plan,
    folder: str,
) -> tuple[tuple[UnitProgram, ...], tuple[Planned, ...]]:
    """Write the files of steps; return all programs, and what events cause, with paths in the folder of the run."""
    if not steps and not planned:
        return programs, ()
    from ur.run.process.described import place_lines, write_files

    placed = (write_files(program, folder) for program in steps)
    return (*programs, *placed), place_lines(planned, plan, folder)


def _report_share(options: RunOptions) -> Callable[[], Event] | None:
    restart = options.restart_share
    if restart is None:
        return None

    def report() -> Event:
        problem = restart()
        return ShareFailed(problem) if problem else ShareStarted()

    return report


def find_middleware(
    plan: Plan, environment: Mapping[str, str], world: World, options: RunOptions, console: Console
) -> Middleware:
    """Find the middleware of a run. Raises UserError if the selected robot has no master, or one cannot start."""
    if plan.launcher == "other":
        from ur.run.middleware.foreign import find_foreign

        return find_foreign(environment)
    if environment.get("ROS_VERSION") == "0":
        from ur.run.middleware.one_process import find_process

        return find_process(environment, options)
    if environment.get("ROS_VERSION") == "2":
        from ur.run.middleware.ros2 import find_ros2

        return find_ros2(environment, options)
    from ur.run.middleware.ros1 import find_ros1

    return find_ros1(environment, world, options, console)


Registered = tuple[RunEntry, socket.socket | None]


def register(
    plan: Plan, address: str, folder: str, environment: Mapping[str, str], console: Console, *, detached: bool
) -> Registered:
    """Enter a run in the registry. The socket is None if that fails, which raises UserError for a detached run."""
    pid = os.getpid()
    title, name = make_run_name(plan.files, pid)
    computer = read_computer()
    entry = RunEntry(
        name,
        pid,
        read_birth(pid) or 0,
        title,
        address,
        folder,
        time.time(),
        detached,
        computer.host,
        machine=computer.machine,
        boot=computer.boot,
    )
    made = register_run(entry, environment, os.getuid())
    if made is not None:
        return made
    folders = " or ".join(runs_folders(environment, os.getuid()))
    if detached:
        raise user_error(
            f"no private folder for the run can be made in {folders}, so it cannot be reached once detached",
            rule="bad-state-folder",
            help="they belong to another user or cannot be written: XDG_STATE_HOME chooses another place",
        )
    console.warn(
        f"this run is not listed by 'ur ps': no private folder for it can be made in {folders}; "
        "XDG_STATE_HOME chooses another place"
    )
    return entry, None


def claim(entry: RunEntry, nodes: Sequence[NodeSpec], plan: Plan, options: RunOptions) -> None:
    """Publish the nodes that a run starts and the runs it has joined to other launches, and to the joined runs."""
    if entry.folder:
        from ur.run.join.decision import make_claims, write_claims

        with suppress(OSError):  # a full disk: other launches still find the nodes while they run
            write_claims(entry.folder, make_claims(nodes, plan.params, (each.run for each in options.owners)))
    from ur.run.record.registry import plan_path, write_plan

    with suppress(OSError):  # a report is then without the plan
        write_plan(plan_path(entry.log_folder, entry.run), plan, nodes, sys.argv)
    for owner in options.owners:
        with suppress(OSError):  # it is ending, and this run ends with it
            note_user(owner.folder, entry.run)
    if options.call_registered is not None:
        options.call_registered()


def list_joined_runs(entry: RunEntry) -> Sequence[str]:
    """Return the ids of the runs that have joined a run, which are users of it."""
    if not list_users(entry.folder):
        return ()
    from ur.run.join.owner import list_joined

    return list_joined(entry.run, os.environ, os.getuid())


def plan_clients(
    here: Registered, nodes: tuple[NodeSpec, ...], options: RunOptions, environment: Mapping[str, str]
) -> RunClients:
    """Plan the monitoring of a registered run: its socket, viewer, event file and end record.

    `environment` is that of the nodes, of which a black box takes events.
    """
    entry, listener = here
    call = options.call_started

    def describe() -> RunStarted:
        from ur.run.clients.protocol import RunStarted  # imported late: only for clients

        return RunStarted(
            run=entry.run,
            pid=entry.pid,
            title=entry.title,
            master_uri=entry.master_uri,
            log_folder=entry.log_folder,
            started=entry.started,
            detached=entry.detached,
            terminal=next((node.full_name for node in nodes if node.terminal), ""),
        )

    def record(exit_code: int, cause: str, lines: Sequence[str], logs: dict[str, str]) -> None:
        from ur.run.record.registry import EndedRun, write_ended  # only at the end

        ended = EndedRun(entry, time.time(), exit_code, cause, tuple(lines), logs)
        write_ended(ended, os.environ, os.getuid())

    return RunClients(
        describe=describe,
        record_end=record if entry.folder else None,
        report_event=partial(notify_black_boxes, environment),
        listener=listener,
        viewer=options.viewer,
        events=options.events,
        unattended=call is not None,
        call_started=None if call is None else lambda: call(entry),
    )
