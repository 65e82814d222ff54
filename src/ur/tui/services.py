"""The computer of the interface: its clock, its pager, its debuggers."""

import os
import shlex
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager

from ur.run.clients.run_state import NodeRow
from ur.run.debugger.choice import DebuggerCommand, choose_debugger
from ur.run.debugger.environment import find_debug_tools, read_node_facts


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
