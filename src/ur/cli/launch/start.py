"""A run of `ur launch`: its host, its plan, its interface, its end."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from ur.request.options import LaunchOptions, Reporter
from ur.robot.selection import Selection
from ur.source.diagnostic import Diagnostic, Severity, UserError, error

if TYPE_CHECKING:
    from ur.launchfile.plan.model import Plan
    from ur.run.clients.protocol import Severity as EventSeverity
    from ur.run.output.console import Console
    from ur.run.process.detach import Detach
    from ur.run.record.entry import RunEntry
    from ur.tui.start import Viewer


def describe_finding(finding: Diagnostic) -> tuple[EventSeverity, str]:
    """A finding in a launch file as severity and text for the interface's log."""
    from ur.source.render import render_human

    severity: EventSeverity = "warning" if finding.severity is Severity.WARNING else "info"
    return severity, render_human([finding], colour=False).rstrip()


def run_launch(
    argv: Sequence[str], selection: Selection, options: LaunchOptions, reporter: Reporter, detach: Detach | None
) -> int:
    """Start what a command line asks for, and return the exit code once it has ended. Raises UserError."""
    from ur.run.process.host_client import start_host  # now, not before: help and completion need none of it

    host = start_host()  # its start overlaps with the reading of the launch file
    stack = ExitStack()
    try:
        from ur.cli.launch.missing import load_with_packages
        from ur.request.joining.join import Joined, join
        from ur.request.joining.running import lock_launch, refuse_second_master
        from ur.request.requirements.preparation import prepare_world
        from ur.request.run_options import make_run_options
        from ur.run.launch import run_plan

        lock = lock_launch(options, stack, reporter.report)
        request, loaded = load_with_packages(argv, selection, options, reporter)
        plan = loaded.plan
        if plan is None:
            _write_findings(loaded.findings, options)
            return 1
        if options.core:
            refuse_second_master()
        world = prepare_world(request.files.paths, plan, loaded.world, complete=options.part is None)
        restart_share = None
        client = os.urandom(8).hex()
        joined = Joined(plan, {})
        if options.part is None:
            found = join(loaded, client, reporter.report)
            if found is None:
                return 0
            joined = found
            plan = joined.plan
            if not selection.simulated:
                from ur.run.remote.own_clients import clients_folder, hold_client

                stack.enter_context(hold_client(client, clients_folder(os.environ, os.getuid())))
        if loaded.robot and any(node.machine == loaded.robot for node in plan.nodes):
            from ur.request.remote.on_robot import start_there  # ssh, and what comes with it: only where it is needed

            part = stack.enter_context(start_there(replace(loaded, plan=plan), client, reporter.report))
            plan, restart_share = part.here, part.again.start
            if not plan.nodes:
                lock.release()
                return part.follow()
        if options.debug:
            from ur.request import debugging

            terminal = not (options.detach or options.json) and debugging.has_terminal()
            plan, lines = debugging.debug_nodes(plan, options.debug, world, terminal=terminal)
            if lines:
                reporter.report("warning", "\n".join(lines))
        with _pid_file(options.pid), _viewer(plan, options, reporter) as viewer:
            console = _make_console(viewer)
            try:
                run_options = replace(
                    make_run_options(request, _call_started(console, detach)),
                    environment=joined.environment,
                    restart_share=restart_share,
                    owners=joined.owners,
                    call_registered=lock.release,
                    viewer=viewer.link if viewer is not None else None,
                )
                return run_plan(plan, world, host, console, run_options)
            finally:
                console.finish(1.0)
    finally:
        host.close()
        stack.close()


def _call_started(console: Console, detach: Detach | None) -> Callable[[RunEntry], None] | None:
    """The call that lets the terminal of a detached run go; None for a run that keeps it."""
    if detach is None:
        return None

    def leave(entry: RunEntry) -> None:
        console.finish(1.0)
        console.calm()
        detach(entry)

    return leave


def _write_findings(findings: Sequence[Diagnostic], options: LaunchOptions) -> None:
    if options.report is not None:
        write_report(findings, options.report)


def write_report(diagnostics: Iterable[Diagnostic], path: str) -> None:
    """Write errors to a file, for the laptop that has asked for this run."""
    import json
    from contextlib import suppress
    from pathlib import Path

    errors = [each for each in diagnostics if each.severity is Severity.ERROR]
    fields = [
        {
            "message": each.message,
            "help": each.help or "",
            "rule": each.rule,
            "place": str(each.span) if each.span else "",
        }
        for each in errors
    ]
    with suppress(OSError):
        Path(path).write_text(json.dumps(fields), encoding="utf-8")


def _make_console(viewer: Viewer | None) -> Console:
    """The console; what it prints before the interface opens is the beginning of the interface's log too."""
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
def _viewer(plan: Plan, options: LaunchOptions, reporter: Reporter) -> Iterator[Viewer | None]:
    """Open the interface, on a terminal that no node needs. Its log begins with what was reported so far."""
    if options.plain or options.json or options.detach or any(node.terminal for node in plan.nodes):
        yield None
        return
    from ur.tui.start import Viewer, look_for_mode

    mode = look_for_mode(os.environ, calm=options.calm)
    if mode == "plain":
        yield None
        return
    with Viewer(mode) as viewer:
        for note in (*map(describe_finding, plan.diagnostics), *reporter.notices):
            viewer.note(*note)
        yield viewer


class _pid_file:  # noqa: N801 - used like a function: with _pid_file(path)
    """A file with our process id, for as long as we run."""

    def __init__(self, path: str | None) -> None:
        self._path = path

    def __enter__(self) -> None:
        if self._path:
            from pathlib import Path

            try:
                Path(self._path).expanduser().write_text(str(os.getpid()), encoding="ascii")
            except OSError as problem:
                reason = (problem.strerror or str(problem)).lower()
                raise UserError(
                    error(f"--pid {self._path}: cannot be written: {reason}", rule="bad-pid-file", subject=self._path)
                ) from None

    def __exit__(self, *_: object) -> None:
        if self._path:
            from pathlib import Path

            Path(self._path).expanduser().unlink(missing_ok=True)
