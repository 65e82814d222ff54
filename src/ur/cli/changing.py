"""Output about changes to a computer: the differences, and the progress of a long change."""

from __future__ import annotations

import shutil
import sys
import threading
import time
from collections.abc import Sequence

import click

from ur.robot.setup.change import Change
from ur.source.printable import printable, printable_lines

PROGRESS_SECONDS = 15.0  # s between lines of progress on output where they cannot be overwritten

_CLEAR = "\r\033[K"


def show_changes(changes: Sequence[Change]) -> None:
    """Print changes one after the other, in colour on a terminal."""
    for change in changes:
        click.echo(f"{click.style(printable(change.title), bold=True)}:")
        for line in map(printable, change.difference.splitlines()):
            colour = {"+": "green", "-": "red", "@": "cyan"}.get(line[:1])
            click.echo(f"  {click.style(line, fg=colour)}")


class ChangeReporter:
    """Prints lines about one robot, each with its name as a prefix unless that is empty.

    With `live`, progress is one line.
    """

    def __init__(self, name: str, *, live: bool = False) -> None:
        self._prefix, self._live = f"{printable(name)}: " if name else "", live
        self._shown = 0.0  # time of the last printed progress
        self._lock = threading.Lock()  # progress comes from another thread

    def __call__(self, text: str) -> None:
        """Print a line."""
        with self._lock:
            sys.stdout.write(f"{_CLEAR if self._live else ''}{self._prefix}{printable_lines(text)}\n")
            sys.stdout.flush()

    def show_progress(self, title: str, seconds: float, line: str) -> None:
        """Print the progress of a long change with its last line of output, which comes from the other computer."""
        text = f"{self._prefix}{title}, {seconds:.0f} s: {printable(line)}"
        with self._lock:
            if self._live:
                sys.stdout.write(_CLEAR + text[: shutil.get_terminal_size().columns - 1])
            elif time.monotonic() - self._shown >= PROGRESS_SECONDS:
                self._shown = time.monotonic()
                sys.stdout.write(text[:160] + "\n")
            sys.stdout.flush()
