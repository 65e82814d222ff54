"""`ur launch`: start a launch file, in place of roslaunch: read the arguments, then answer a query, or run.

The imports of each branch are inside it: a start has to be fast. Nothing here imports click.
"""

from __future__ import annotations

import gc
import os
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from typing import TYPE_CHECKING

from ur.request.environment import apply_selection, current_selection, own_packages
from ur.request.launch_request import LaunchOptions, StartReporter, check_options, choose_query, follow_file
from ur.robot.selection import Selection
from ur.source.diagnostic import Diagnostic, Severity, UserError, user_error

if TYPE_CHECKING:
    from ur.launchfile.plan.specs import Plan
    from ur.run.clients.protocol import Severity as EventSeverity
    from ur.run.detach import Detach
    from ur.run.output.console import Console
    from ur.run.record.registry import RunEntry
    from ur.source.arguments import CommandLine
    from ur.tui.start import InterfaceProcess

# roslaunch exits with 2 for errors that optparse finds, and with 1 for later ones.
_WRONG_ARGUMENTS = frozenset({"bad-argument", "bad-options", "refused-option"})
# Queries about the files: no robot is contacted for its base, and they need no ROS.
OF_FILES = frozenset({"nodes", "files", "find-node", "args"})


def launch(argv: Sequence[str]) -> int:
    """Start a launch file, in place of roslaunch.

    Starts a master where none runs, and stops everything again at the end: on Ctrl-C, when a required node ends, or
    when all nodes have ended. Options have the same meaning as for roslaunch.
    """
    gc.disable()  # garbage collection is useless before a run
    from ur.cli.launch.options import read_launch

    report = None
    try:
        own, command = split_command(argv)
        line, options = read_launch([*own, "-"] if command else own)
        report = options.report
        if command:
            if len(line.names) > 1 or line.arguments or options.queries:
                help_ = f"write {' '.join(command)} alone"
                raise user_error("'--' has a launch file or a query before it", rule="bad-options", help=help_)
            return launch_other(command, line, options)
        check_options(line.names, options)
        return launch_line(line, options)
    except UserError as problem:
        return explain_problem(problem, report)


def split_command(argv: Sequence[str]) -> tuple[Sequence[str], Sequence[str]]:
    """Return the arguments before '--', and the command of another launcher behind it, () without one.

    What follows '--' is a command if it begins with a program: elsewhere '--' ends the options.
    """
    place = argv.index("--") if "--" in argv else len(argv)
    command = argv[place + 1 :]
    if not command or ".launch" in command[0] or shutil.which(command[0]) is None:
        return argv, ()
    return argv[:place], command


def launch_other(command: Sequence[str], line: CommandLine, options: LaunchOptions) -> int:
    """Run another launcher to its end, and return its exit code; nothing that it has started is left."""
    check_options(line.names, options)
    from ur.request.foreign import make_foreign_plan, run_foreign
    from ur.run.process.host_client import start_host

    plan = make_foreign_plan(command, terminal=not options.detach)

    def run(detach: Detach | None) -> int:
        with closing(start_host()) as host:
            console = _make_console(None)
            gc.enable()
            try:
                return run_foreign(plan, options, host, console, _call_started(console, detach))
            finally:
                console.finish(1.0)

    if not options.detach:
        return run(None)
    from ur.cli.runs.wait import start_detached

    return start_detached(run, wait=options.timeout_ready if options.wait else None)


def launch_line(line: CommandLine, options: LaunchOptions) -> int:
    """Answer the query or launch the file of a command line, and return the exit code. Raises UserError."""
    query = choose_query(options.queries)
    if query is not None and query[0] == "dump":
        return _print_dump(line, options)
    shell, selection, reporter = dict(os.environ), current_selection(os.environ), StartReporter()
    if query is None or query[0] not in OF_FILES or not selection.base:
        from ur.request.bases.robot_facts import know_robot

        selection = know_robot(selection, os.environ, line.arguments, reporter.report)
    followed = selection if options.part is not None else follow_file(line, selection, reporter.report)
    if query is not None and query[0] != "dry-run":
        from ur.request.questions import answer

        if followed is not selection:  # its packages are not those of the shell
            apply_selection(followed)
            shell = dict(os.environ)
        return answer(line, followed, query, shell)
    selection = followed
    apply_selection(selection)
    if query is not None:
        return _dry_run(line, selection, options, reporter, shell)
    if not options.detach:
        return run_launch(line, selection, options, reporter, None)
    from ur.cli.runs.wait import start_detached

    return start_detached(
        lambda detach: run_launch(line, selection, options, reporter, detach),
        wait=options.timeout_ready if options.wait else None,
    )


def _print_dump(line: CommandLine, options: LaunchOptions) -> int:
    """Print the plan as JSON with sorted keys; return 1 if roslaunch refuses the file.

    The selection is ignored: the same arguments and environment have the meaning that they have for roslaunch.
    """
    import json

    from ur.launchfile.dump import dump_plan, dump_refusal
    from ur.launchfile.load import load_plan
    from ur.launchfile.plan.commands import refuse_command, run_command
    from ur.request.launch_request import make_request
    from ur.request.plan_files import texts
    from ur.request.questions import make_world

    world = make_world(os.environ, anonymous=True)
    try:
        files = make_request(line, world).files
        plan = load_plan(files.paths, texts(line.arguments), world, parsed=files.parsed)
        run = refuse_command if options.no_commands else run_command
        dumped = dump_plan(plan, with_origins=options.with_origins, run=run)
    except UserError as problem:
        dumped = dump_refusal(problem.diagnostics)
    sys.stdout.write(json.dumps(dumped, sort_keys=True, indent=2) + "\n")
    sys.stdout.flush()
    return 0 if dumped["ok"] else 1


def _dry_run(
    line: CommandLine, selection: Selection, options: LaunchOptions, reporter: StartReporter, shell: dict[str, str]
) -> int:
    from ur.request.dry_run import format_dry_run
    from ur.request.launch_request import make_request
    from ur.request.plan_files import load_chosen, make_world

    loaded = load_chosen(make_request(line, make_world(), selection, options), reporter.report)
    if loaded.plan is None:
        return 1
    lines, problems = format_dry_run(loaded.plan, loaded.world, shell, line.argv)
    sys.stdout.write("".join(f"{line}\n" for line in lines))
    sys.stdout.flush()
    if problems:
        _print_diagnostics(problems)
    return 1 if problems else 0


def run_launch(
    line: CommandLine, selection: Selection, options: LaunchOptions, reporter: StartReporter, detach: Detach | None
) -> int:
    """Run the launch file of a command line, and return the exit code once it has ended. Raises UserError."""
    from ur.run.process.host_client import start_host  # imported late: help and completion do not need it

    with ExitStack() as stack, closing(start_host()) as host:  # its start overlaps with the reading of the launch file
        from ur.request.launch import Launch, prepare, run

        launch = Launch(line, selection, options, reporter, stack, make_xacro, lambda names: offer(options, names))
        staged = prepare(launch)
        gc.enable()
        if staged.end is not None:
            return staged.end()
        with _pid_file(options.pid, staged.plan.files), _viewer(staged.plan, options, reporter) as viewer:
            console = _make_console(viewer)
            try:
                link = viewer.link if viewer is not None else None
                return run(staged, host, console, link, _call_started(console, detach))
            finally:
                console.finish(1.0)


def _call_started(console: Console, detach: Detach | None) -> Callable[[RunEntry], None] | None:
    """Return the callback that detaches a run from its terminal; None for a run that keeps it."""
    if detach is None:
        return None

    def leave(entry: RunEntry) -> None:
        console.finish(1.0)
        console.calm()
        detach(entry)

    return leave


def _make_console(viewer: InterfaceProcess | None) -> Console:
    """Return the console; its output before the interface opens is also the beginning of the interface's log."""
    from ur.run.output.console import Console

    if viewer is None:
        return Console()

    note = viewer.note

    class Noting(Console):
        def warn(self, text: str) -> None:
            if not self.silent:
                note("warning", text)
            super().warn(text)

        def fail(self, text: str) -> None:
            if not self.silent:
                note("error", text)
            super().fail(text)

    return Noting()


@contextmanager
def _viewer(plan: Plan, options: LaunchOptions, reporter: StartReporter) -> Iterator[InterfaceProcess | None]:
    """Open the interface, on a terminal that no node needs. Its log begins with earlier reports."""
    if options.plain or options.json or options.detach or any(node.terminal for node in plan.nodes):
        yield None
        return
    from ur.tui.start import InterfaceProcess, look_for_mode

    if (mode := look_for_mode(os.environ, calm=options.calm)) == "plain":
        yield None
        return
    with InterfaceProcess(mode) as viewer:
        for note in (*map(_describe_finding, plan.diagnostics), *reporter.notices):
            viewer.note(*note)
        yield viewer


@contextmanager
def _pid_file(path: str | None, inputs: Iterable[str]) -> Iterator[None]:
    """Context in which a file with the id of this process exists."""
    if not path:
        yield
        return
    from ur.source.replace import output_file

    name = os.path.expanduser(path)  # noqa: PTH111 - pathlib takes time to load
    with output_file(name, inputs, tuple(b"%d" % digit for digit in range(10))) as file:
        file.write(b"%d" % os.getpid())
    try:
        yield
    finally:
        with suppress(FileNotFoundError):
            os.unlink(name)  # noqa: PTH108


def _describe_finding(finding: Diagnostic) -> tuple[EventSeverity, str]:
    """Return severity and text of a finding in a launch file, for the interface's log."""
    from ur.source.render import render_human

    return "warning" if finding.severity is Severity.WARNING else "info", render_human([finding], colour=False).rstrip()


def make_xacro() -> None:
    """Build the ROS package xacro. Raises UserError."""
    from pathlib import Path

    from ur.get.install import install_xacro

    sys.stderr.write("installing xacro, once ...\n")
    install_xacro(Path(own_packages(os.environ)))


def offer(options: LaunchOptions, names: Iterable[str]) -> bool:
    """Ask whether `ur get` may search for packages, and run it; return True once one has been installed."""
    from ur.get.install import make_offer

    offered = make_offer(names)
    if offered is None:
        return False
    if not _can_ask(options):
        sys.stderr.write(f"help: {offered.help}\n")
        return False
    import click

    if not click.confirm(offered.question, default=True, err=True):
        return False
    from ur.cli.files.get import get_packages

    before = offered.count_installed(os.environ)
    get_packages(offered.names)
    return offered.count_installed(os.environ) > before


def _can_ask(options: LaunchOptions) -> bool:
    return sys.stdin.isatty() and sys.stderr.isatty() and not (options.json or options.detach or options.part)


def explain_problem(problem: UserError, report: str | None = None) -> int:
    """Print errors about the user's input, and write them to `report` too; return the exit code."""
    if report is not None:
        from ur.request.launch import write_report

        write_report(problem.diagnostics, report)
    _print_diagnostics(problem.diagnostics)
    return 2 if any(each.rule in _WRONG_ARGUMENTS for each in problem.diagnostics) else 1


def _print_diagnostics(diagnostics: Sequence[Diagnostic]) -> None:
    from ur.source.render import render_human, shows_colour

    sys.stderr.write(render_human(diagnostics, colour=shows_colour(sys.stderr)))
