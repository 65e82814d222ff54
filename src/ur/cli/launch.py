"""`ur launch`: start a launch file, in place of roslaunch."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import click

from ur.cli.environment import apply_selection, current_selection
from ur.robot.selection import Selection
from ur.source.diagnostic import UserError, error

if TYPE_CHECKING:
    from ur.launchfile.plan.model import Plan
    from ur.run.console import Console
    from ur.run.detach import LetGo
    from ur.run.launch import Options
    from ur.run.registry import RunEntry
    from ur.run.timings import Timings
    from ur.tui.start import Viewer

_Query = tuple[str, str | None]
_SECONDS = click.FloatRange(min=0, min_open=True)
_NOTHING_TO_DO = ("-v", "--no-summary", "--skip-log-check", "--disable-title", "--local")
_REFUSED = {
    "--core": "ur starts a master with the first launch file; 'roscore' starts one alone",
    "-c": "ur has no child mode; it is how roslaunch starts itself on other computers",
    "-u": "ur has no child mode; it is how roslaunch starts itself on other computers",
    "--run_id": "the run id is the master's, or a new one where ur starts the master",
}


@dataclass(slots=True)
class _Wishes:
    """The options of the command line, as click found them."""

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
    prefix: Sequence[str] = ()
    debug: Sequence[str] = ()
    detach: bool = False
    plain: bool = False
    calm: bool = False
    json: bool = False
    timeout_ready: float = 30.0
    respawn_limit: int | None = None
    timings: bool = False
    queries: Sequence[_Query] = field(default=())


def _parameters() -> list[click.Parameter]:
    def flag(*names: str, **more: Any) -> click.Option:
        return click.Option(names, is_flag=True, **more)

    def refuse(ctx: click.Context, param: click.Parameter, value: object) -> None:
        if value and not ctx.resilient_parsing:
            name = param.opts[0]
            raise UserError(error(f"{name} is not for ur launch: {_REFUSED[name]}", rule="refused-option"))

    return [
        flag("--screen", help="Show the output of every node."),
        flag("--log", help="Keep the standard output of every node in log files."),
        flag("--required", help="End the run with the first node that ends."),
        click.Option(["--only"], multiple=True, metavar="NODE", help="Start only this node; may be repeated."),
        click.Option(["--except", "except_"], multiple=True, metavar="NODE", help="Do not start this node."),
        click.Option(
            ["--prefix"], multiple=True, metavar="NODE=PREFIX", help="Put a program in front: 'talker=gdb --args'."
        ),
        click.Option(
            ["--debug"],
            multiple=True,
            metavar="NODE[=TOOL]",
            help="Start this node under a debugger: pudb, gdb or debugpy; may be repeated.",
        ),
        flag("--detach", help="Start it, and let it run on without this terminal: ur ps, attach, logs, stop."),
        flag("--plain", "--no-ui", help="Print lines, as roslaunch does, also on a terminal."),
        flag("--calm", help="Show one line that says how the run stands, and what goes wrong."),
        flag("--json", help="Print everything that happens as lines of JSON."),
        flag("--wait", help="Wait for a master instead of starting one; with --detach: until every node is up."),
        flag("--timings", help="Say what the start spent its time on, once every node is up."),
        click.Option(
            ["--timeout-ready"],
            type=_SECONDS,
            default=30.0,
            show_default=True,
            help="With --detach --wait: seconds that nodes get to be up.",
        ),
        click.Option(
            ["--respawn-limit"],
            type=click.IntRange(0),
            help="Give a respawning node up after so many quick deaths (default 10); 0: never, as roslaunch.",
        ),
        click.Option(["-p", "--port"], type=click.IntRange(1, 65535), help="Port of the master that is started."),
        click.Option(["-w", "--numworkers"], type=click.IntRange(1), help="Threads of the master that is started."),
        click.Option(["-t", "--timeout"], type=_SECONDS, help="Socket timeout of the master that is started."),
        click.Option(
            ["--master-logger-level"],
            type=click.Choice(["debug", "info", "warn", "error", "fatal"]),
            help="What the master that is started logs.",
        ),
        click.Option(["--pid"], metavar="FILE", help="Write the process id to a file while it runs."),
        click.Option(["--sigint-timeout"], type=_SECONDS, help="Seconds from SIGINT to SIGTERM at the end."),
        click.Option(["--sigterm-timeout"], type=_SECONDS, help="Seconds from SIGTERM to SIGKILL at the end."),
        flag("--nodes", help="Print the names of the nodes."),
        flag("--files", help="Print the launch files that are read."),
        click.Option(["--find-node"], metavar="NODE", help="Print the launch file that defines a node."),
        click.Option(["--args"], metavar="NODE", help="Print the command line that starts a node."),
        flag("--dump-params", help="Print the parameters as YAML."),
        flag("--ros-args", help="Print the arguments of the launch file."),
        flag("--dry-run", help="Print what would be started: command, environment and machine of every node."),
        click.Option(["--dump"], type=click.Choice(["json"]), help="Print all that the launch file means."),
        flag("--with-origins", help="With --dump: where everything comes from."),
        flag("--no-commands", help="With --dump: do not run the programs of <param command>; refuse them."),
        *(flag(name, hidden=True, expose_value=False) for name in _NOTHING_TO_DO),
        flag("--core", hidden=True, expose_value=False, callback=refuse),
        *(
            click.Option(names, hidden=True, expose_value=False, callback=refuse)
            for names in (["-c", "--child"], ["-u", "--server_uri"], ["--run_id"])
        ),
        click.Argument(["words"], nargs=-1, required=True, metavar="[PACKAGE] FILE [ARG:=VALUE]..."),
    ]


def launch(
    words: tuple[str, ...],
    nodes: bool,
    files: bool,
    find_node: str | None,
    args: str | None,
    dump_params: bool,
    ros_args: bool,
    dry_run: bool,
    dump: str | None,
    with_origins: bool,
    no_commands: bool,
    **options: Any,
) -> int:
    """Start a launch file, in place of roslaunch.

    The file is given by path, or as a package and a file name. Starts a master where none runs, and stops everything
    again at the end: on Ctrl-C, when a required node ends, or when all nodes have ended. Options mean what they mean to
    roslaunch.
    """
    flags = {"nodes": nodes, "files": files, "dump-params": dump_params, "ros-args": ros_args, "dry-run": dry_run}
    queries: list[_Query] = [(name, None) for name, asked in flags.items() if asked]
    queries += [(name, node) for name, node in (("find-node", find_node), ("args", args), ("dump", dump)) if node]
    wishes = _Wishes(**options, queries=queries)
    if wishes.screen and wishes.log:
        raise UserError(error("--screen and --log exclude each other, expected one", rule="bad-options"))
    if wishes.detach and wishes.json:
        help_ = "'ur attach --json' prints the events of a run that is detached"
        raise UserError(error("--detach and --json exclude each other", rule="bad-options", help=help_))
    if len(queries) > 1:
        names = " and ".join(f"--{name}" for name, _ in queries)
        raise UserError(error(f"{names} exclude each other, expected one", rule="bad-options"))
    if (with_origins or no_commands) and not dump:
        raise UserError(error("--with-origins and --no-commands belong to --dump json", rule="bad-options"))
    shell = dict(os.environ)
    if dump:
        from ur.cli.dump import print_dump

        return print_dump(words, shell, with_origins=with_origins, no_commands=no_commands)
    selection = _know_base(words)
    if queries and not dry_run:
        from ur.cli.queries import answer

        return answer(words, selection, queries[0], shell)
    apply_selection(selection)
    if not selection.simulated and os.environ["ROS_MASTER_URI"] != selection.master_uri:
        sys.stderr.write(f"ROS_MASTER_URI={os.environ['ROS_MASTER_URI']} was set by hand: {selection} is not used\n")
    return _dry_run(words, selection, wishes, shell) if dry_run else _start(words, selection, wishes)


def _know_base(words: Sequence[str]) -> Selection:
    from ur.cli.robot_facts import know_base

    selected = current_selection(os.environ)
    known = know_base(selected, os.environ)
    if selected.base not in ("", known.base) and not any(word.startswith("robot_base:=") for word in words):
        sys.stderr.write(f"the robot that runs already is a {known.base}: the selection {selected} is not used\n")
    return known


command = click.Command("launch", callback=launch, params=_parameters(), help=launch.__doc__)


def _dry_run(words: Sequence[str], selection: Selection, wishes: _Wishes, shell: dict[str, str]) -> int:
    from ur.cli.dry_run import print_dry_run
    from ur.cli.plan_files import load_words

    plan, world = load_words(words, selection)
    return 1 if plan is None else print_dry_run(_choose(plan, wishes), world, shell, words)


def _choose(plan: Plan, wishes: _Wishes) -> Plan:
    if not (wishes.only or wishes.except_ or wishes.prefix):
        return plan
    from ur.cli.choice import choose_nodes

    return choose_nodes(plan, wishes.only, wishes.except_, wishes.prefix)


def _start(words: Sequence[str], selection: Selection, wishes: _Wishes) -> int:
    if wishes.detach:
        from ur.cli.detached import start_detached

        return start_detached(
            lambda let_go: _run(words, selection, wishes, let_go), wait=wishes.timeout_ready if wishes.wait else None
        )
    return _run(words, selection, wishes, None)


def _run(words: Sequence[str], selection: Selection, wishes: _Wishes, let_go: LetGo | None) -> int:
    from ur.run.processes import start_host  # now, not before: help and completion need none of it

    host = start_host()  # its start overlaps with the reading of the launch file
    try:
        from ur.cli.plan_files import load_words
        from ur.cli.preparation import prepare
        from ur.run.console import Console
        from ur.run.launch import run_plan

        plan, world = load_words(words, selection)
        if plan is None:
            return 1
        plan = _choose(plan, wishes)
        prepare(plan, world)
        if wishes.debug:
            from ur.cli import debugging

            terminal = not (wishes.detach or wishes.json) and debugging.has_terminal()
            plan, told = debugging.debug_nodes(plan, wishes.debug, world, terminal=terminal)
            debugging.tell(told)
            wishes.plain = wishes.plain or bool(told)  # it says what to type; that has to stay on the screen
        console = Console()
        try:
            with _pid_file(wishes.pid):
                options = _options(words, selection, wishes, console, let_go)
                with _viewer(plan, wishes) as viewer:
                    if viewer is not None:
                        options = replace(options, viewer=viewer.link)
                    return run_plan(plan, world, host, console, options)
        except UserError as problem:
            from ur.source.render import render_human

            console.finish(1.0)
            sys.stderr.write(render_human(problem.diagnostics, colour=sys.stderr.isatty()))
            return 1
    finally:
        host.close()


@contextmanager
def _viewer(plan: Plan, wishes: _Wishes) -> Iterator[Viewer | None]:
    """The interface, where there is a terminal that no node needs."""
    if wishes.plain or wishes.json or wishes.detach or any(node.terminal for node in plan.nodes):
        yield None
        return
    from ur.tui.start import Viewer, look_for_mode

    mode = look_for_mode(os.environ, calm=wishes.calm)
    if mode == "plain":
        yield None
        return
    with Viewer(mode) as viewer:
        yield viewer


def _options(
    words: Sequence[str], selection: Selection, wishes: _Wishes, console: Console, let_go: LetGo | None
) -> Options:
    from ur.run.launch import Options
    from ur.run.model import Limits

    given = dict(word.split(":=", 1) for word in words if ":=" in word)
    base = given.get("robot_base", selection.base)
    defaults = Limits()

    def leave(entry: RunEntry) -> None:
        console.finish(1.0)
        console.calm()
        if let_go is not None:
            let_go(entry)

    master_words = []
    if wishes.timeout is not None:
        master_words += ["-t", str(wishes.timeout)]
    if wishes.master_logger_level is not None:
        master_words += ["--master-logger-level", wishes.master_logger_level]
    return Options(
        limits=Limits(
            interrupt=wishes.sigint_timeout or defaults.interrupt,
            terminate=wishes.sigterm_timeout or defaults.terminate,
            quick_deaths=defaults.quick_deaths if wishes.respawn_limit is None else wishes.respawn_limit,
        ),
        force_screen=wishes.screen,
        force_log=wishes.log,
        force_required=wishes.required,
        wait_for_master=wishes.wait and not wishes.detach,
        port=wishes.port,
        workers=wishes.numworkers,
        master_words=tuple(master_words),
        base=base,
        variant=given.get("robot_variant", selection.variant if base == selection.base else ""),
        events=1 if wishes.json else None,
        timings=_begin_timings() if wishes.timings else None,
        call_started=None if let_go is None else leave,
    )


def _begin_timings() -> Timings:
    from ur.run.timings import begin_timings

    timings = begin_timings()
    timings.mark("launch file")
    return timings


class _pid_file:  # noqa: N801 - used like a function: with _pid_file(path)
    """A file with our process id, for as long as we run."""

    def __init__(self, path: str | None) -> None:
        self._path = path

    def __enter__(self) -> None:
        if self._path:
            from pathlib import Path

            try:
                Path(self._path).write_text(str(os.getpid()), encoding="ascii")
            except OSError as problem:
                reason = (problem.strerror or str(problem)).lower()
                raise UserError(
                    error(f"--pid {self._path}: cannot be written: {reason}", rule="bad-pid-file")
                ) from None

    def __exit__(self, *_: object) -> None:
        if self._path:
            from pathlib import Path

            Path(self._path).unlink(missing_ok=True)
