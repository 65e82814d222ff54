"""Start of a plan: leave out nodes, find programs, find or start the master, and enter the loop."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.world import World
from ur.run.loop import run_loop
from ur.run.master.parameters import check_sendable, start_commands
from ur.run.middleware.choice import find_middleware
from ur.run.middleware.protocol import Middleware
from ur.run.options import RunOptions
from ur.run.output.console import Console
from ur.run.output.log_rotation import read_bounds
from ur.run.paths import make_home, make_run_folder, new_run_id
from ur.run.presence import claim, list_joined_runs, plan_clients, register
from ur.run.process.command import UnitProgram, find_programs, number_logs
from ur.run.process.host_client import HostLost, ProcessHost
from ur.run.process.terminal import find_terminal, ignore_background_write
from ur.run.record.entry import RunEntry
from ur.run.record.registry import unregister_run
from ur.run.run import Run
from ur.run.startup.node_selection import find_remote, find_terminals, force_options, leave_out_viewers
from ur.run.supervisor.events import Event, SetupFailed, ShareFailed, ShareStarted
from ur.source.diagnostic import UserError, error
from ur.source.run_users import FOLDER_VARIABLE

__all__ = ["RunOptions", "run_plan"]


def run_plan(plan: Plan, world: World, host: ProcessHost, console: Console, options: RunOptions) -> int:
    """Run a plan without errors to its end and return the exit code.

    Raises UserError before anything is started, for a missing executable, a node for another computer, an invalid
    parameter value, no master on the selected robot, no folder for log files, or an invalid limit of their size.
    """
    environment = {**world.environment, **options.environment}
    bounds, home = read_bounds(environment), make_home(environment)
    nodes, programs = _find_nodes(plan, world, console, options)
    middleware = find_middleware(environment, world, options, console)
    environment |= middleware.environment
    folder = make_run_folder(environment, middleware.run_id or new_run_id())
    programs = middleware.arrange(number_logs(programs, middleware.logs), nodes, folder)
    commands = start_commands(plan.params, environment)
    if not programs and not middleware.core:
        return _end_without_nodes(middleware.set_parameters(plan, folder, options, commands), console)
    try:
        detached = options.call_started is not None
        entry, listener = register(plan, middleware.address, folder, environment, console, detached=detached)
        claim(entry, nodes, plan, options)
        if keep_terminal := any(
            node.terminal for node in nodes
        ):  # such a program shows the robot's other users; other programs get the environment of roslaunch
            environment[FOLDER_VARIABLE] = entry.folder
        _begin(host, environment, entry, keep_terminal=keep_terminal)
        terminal = None if detached else find_terminal()
        ignore_background_write()
        _announce(console, middleware, folder=folder, nodes=len(nodes))
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
            list_joined=lambda: list_joined_runs(entry),
        )
        try:
            return run_loop(run, host, console, terminal)
        finally:
            unregister_run(entry)
    finally:
        commands.stop()


def _end_without_nodes(done: Event, console: Console) -> int:
    if isinstance(done, SetupFailed):
        raise UserError(error(done.reason, rule="setup-failed"))
    console.inform("parameters are set; there is no node to start")
    console.finish(1.0)
    return 0


def _begin(host: ProcessHost, environment: Mapping[str, str], entry: RunEntry, *, keep_terminal: bool) -> None:
    try:
        host.begin(environment, keep_terminal=keep_terminal)
    except HostLost:
        unregister_run(entry)
        message = "the process host was killed before anything was started"
        raise UserError(error(message, rule="no-process-host", help="start it once more")) from None


def _find_nodes(
    plan: Plan, world: World, console: Console, options: RunOptions
) -> tuple[tuple[NodeSpec, ...], tuple[UnitProgram, ...]]:
    """Return the nodes that run, and their programs. Raises UserError with all errors at once."""
    shown, notes = leave_out_viewers(plan.nodes, world, world.environment)
    for note in notes:
        console.warn(note)
    nodes = tuple(force_options(node, options) for node in shown)
    programs, missing = find_programs(nodes, world)
    problems = [*find_remote(plan, nodes), *missing]
    if problems:
        raise UserError(*problems)
    check_sendable(plan.params)
    problems = find_terminals(nodes, detached=options.call_started is not None)
    if problems:
        raise UserError(*problems)
    return nodes, programs


def _report_share(options: RunOptions) -> Callable[[], Event] | None:
    restart = options.restart_share
    if restart is None:
        return None

    def report() -> Event:
        problem = restart()
        return ShareFailed(problem) if problem else ShareStarted()

    return report


def _announce(console: Console, middleware: Middleware, *, folder: str, nodes: int) -> None:
    console.inform(middleware.describe())
    console.inform(f"{nodes} node{'' if nodes == 1 else 's'}, log files in {folder}")
    if not nodes:
        console.warn("there is no node to start; the master runs until Ctrl-C")
