"""A run of `ur launch`: its host, plan, interface and end."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from typing import TYPE_CHECKING

from ur.request.options import LaunchOptions, StartReporter
from ur.robot.selection import Selection
from ur.source.diagnostic import Diagnostic, Severity

if TYPE_CHECKING:
    from ur.launchfile.plan.specs import Plan
    from ur.run.clients.protocol import Severity as EventSeverity
    from ur.run.detach import Detach
    from ur.run.output.console import Console
    from ur.run.record.entry import RunEntry
    from ur.tui.start import InterfaceProcess


def describe_finding(finding: Diagnostic) -> tuple[EventSeverity, str]:
    """Return severity and text of a finding in a launch file, for the interface's log."""
    from ur.source.render import render_human

    severity: EventSeverity = "warning" if finding.severity is Severity.WARNING else "info"
    return severity, render_human([finding], colour=False).rstrip()


def run_launch(
    argv: Sequence[str], selection: Selection, options: LaunchOptions, reporter: StartReporter, detach: Detach | None
) -> int:
    """Run the launch file of a command line, and return the exit code once it has ended. Raises UserError."""
    from ur.run.process.host_client import start_host  # imported late: help and completion do not need it

    with ExitStack() as stack, closing(start_host()) as host:  # its start overlaps with the reading of the launch file
        from ur.cli.launch.missing import make_xacro, offer
        from ur.request.launch import Launch, prepare, run

        launch = Launch(argv, selection, options, reporter, stack, make_xacro, lambda names: offer(options, names))
        staged = prepare(launch)
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

    mode = look_for_mode(os.environ, calm=options.calm)
    if mode == "plain":
        yield None
        return
    with InterfaceProcess(mode) as viewer:
        for note in (*map(describe_finding, plan.diagnostics), *reporter.notices):
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
