"""Display of a run on this terminal, with the suitable interface: for `ur launch` and `ur attach`."""

import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager

from ur.run.clients.client import RunControl
from ur.run.clients.protocol import RunEvent, StopRun
from ur.run.clients.run_state import NodeRow
from ur.run.debugger.choice import DebuggerCommand, choose_debugger
from ur.run.debugger.environment import find_debug_tools, read_node_facts
from ur.run.host import set_foreground


class SystemServices:
    """The real `ur.tui.run_screen.Services`.

    `suspend` releases the terminal to other programs while its context lasts.
    """

    def __init__(self, environment: Mapping[str, str], suspend: Callable[[], AbstractContextManager[None]]) -> None:
        self._environment = environment
        self._suspend = suspend

    def now(self) -> float:
        """Return the time in s since the epoch."""
        return time.time()

    def has_content(self, path: str) -> bool:
        """Return whether a file exists and is not empty."""
        try:
            return os.path.getsize(path) > 0  # noqa: PTH202 - a path as text
        except OSError:
            return False

    def find_pager(self) -> list[str] | None:
        """Return $PAGER if it can be run, else less; None if there is neither."""
        path = self._environment.get("PATH")
        try:
            chosen = shlex.split(self._environment.get("PAGER", ""))
        except ValueError:
            chosen = []
        if chosen and shutil.which(chosen[0], path=path):
            return chosen
        return ["less", "-R", "+G"] if shutil.which("less", path=path) else None

    def run_here(self, words: Sequence[str]) -> str:
        """Run a command on this terminal. Return the problem, '' for none."""
        before = signal.signal(signal.SIGINT, lambda *_: None)  # Ctrl-C is meant for the command, not for this process
        try:
            with self._suspend():
                subprocess.run(list(words), check=False)
        except OSError as problem:
            return f"{words[0]}: {(problem.strerror or str(problem)).lower()}"
        finally:
            signal.signal(signal.SIGINT, before)
        return ""

    def run_beside(self, words: Sequence[str]) -> str:
        """Start a command that opens a window."""
        quiet = subprocess.DEVNULL
        try:
            subprocess.Popen(list(words), stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True)
        except OSError as problem:
            return f"{words[0]}: {(problem.strerror or str(problem)).lower()}"
        return ""

    def debug(self, row: NodeRow) -> DebuggerCommand | str:
        """Return the debugger for a node, or the reason why there is none."""
        changed = row.changed
        try:
            facts = read_node_facts(row.name, changed.program, changed.pid)
        except PermissionError:
            return f"{row.name} runs as another user, and cannot be debugged"
        python = facts.target.interpreter if facts.target.kind == "python" else ""
        tools = find_debug_tools(self._environment, terminal=os.isatty(0), python=python)
        return choose_debugger(facts, tools)


MOST_REPORTED = 12  # lines about failures that stay on the screen afterwards


def watch_run(
    control: RunControl, mode: str, environment: Mapping[str, str], *, ours: bool, early: Sequence[RunEvent] = ()
) -> tuple[str, int]:
    """Show a run until it ends; return `ended`, `killed` (its supervisor was) or `detached`, and its exit code.

    `mode` is `full` or `calm`. `ours`: the run ends with this terminal. `early`: the events so far. Failures, and
    warnings about the end, are printed again afterwards, so that they stay on the terminal.
    """
    if ours:
        signal.signal(signal.SIGHUP, lambda *_: control.send(StopRun("the terminal was closed")))
    if mode == "calm":
        from ur.tui.status_line import show_status_line

        return show_status_line(control, guest=not ours, early=early)
    return _watch_fully(control, environment, early, guest=not ours)


def _watch_fully(
    control: RunControl, environment: Mapping[str, str], early: Sequence[RunEvent], *, guest: bool
) -> tuple[str, int]:
    from textual.drivers.linux_driver import LinuxDriver

    from ur.tui.app import WatchApp
    from ur.tui.screen.query import ask_background, is_light

    light = is_light(environment, ask_background(1, 1))

    def suspend() -> AbstractContextManager[None]:
        return app.suspend()

    services = SystemServices(environment, suspend)
    app = WatchApp(control, services, light=light, guest=guest, early=early, driver=LinuxDriver)
    how = app.run() or "ended"
    if app.problem is not None:
        raise app.problem
    failures = [entry for entry in app.journal.entries if not entry.name and entry.severity in ("error", "fatal")]
    lines = [line for entry in failures for line in entry.lines]
    for line in (*lines[-MOST_REPORTED:], *app.parting[-MOST_REPORTED:]):
        sys.stderr.write(f"{line}\n")
    if app.state.run.log_folder:
        sys.stderr.write(f"log files in {app.state.run.log_folder}\n")
    return how, app.state.exit_code or 0


def own_terminal(descriptor: int) -> bool:
    """Become the foreground group of the terminal, so that Ctrl-C in a pager or a debugger does not end the run.

    Return False if this process runs in the background, or has no terminal.
    """
    try:
        if os.tcgetpgrp(descriptor) != os.getpgrp():
            return False
        os.setpgid(0, 0)
    except OSError:
        return False
    set_foreground(descriptor, os.getpgrp())
    return True
