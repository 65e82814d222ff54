"""`keyboard_navigate` with commands from a pipe, or from a terminal that takes lines only."""

import os
import select
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator

from ur.source.diagnostic import UserError
from ur_nodes.client.saving import MapSaving, Saving
from ur_nodes.client.snapshot import NavigationClient
from ur_nodes.run import BROKEN_PIPE_EXIT_CODE, drop_output
from ur_nodes.teleop.navigate.batch import (
    BatchContext,
    BatchTimeouts,
    InterruptedBatchError,
    run_batch,
    wait_until_ready,
)
from ur_nodes.teleop.navigate.command_line import StoreChoice
from ur_nodes.teleop.navigate.commands import AskMux, CancelGoal, Command, Quit, parse_command

_PATIENCE = 0.2  # s between two checks of `ended`


class LineReader:
    """Iterates over the lines of a file descriptor as they arrive, until its end or until `ended` is set."""

    def __init__(self, source: int, ended: threading.Event) -> None:
        self._source = source
        self._ended = ended
        self._rest = b""
        self._lines: deque[str] = deque()
        self._open = True

    def __iter__(self) -> Iterator[str]:
        """Yield the lines."""
        while True:
            while not self._lines and self._open and not self._ended.is_set():
                self._read(_PATIENCE)
            if not self._lines or self._ended.is_set():
                return
            yield self._lines.popleft()

    def pop_urgent(self) -> Command | None:
        """Take the first urgent command: stop, emergency, release, quit. Never blocks.

        After `quit` no further line is read.
        """
        self._read(0.0)
        for line in self._lines:
            try:
                command = parse_command(line)
            except UserError:
                continue  # it is reported at its turn
            if isinstance(command, (CancelGoal, AskMux, Quit)):
                self._lines.remove(line)
                if isinstance(command, Quit):
                    self._lines.clear()
                    self._open = False
                return command
        return None

    def _read(self, patience: float) -> None:
        if not self._open or not select.select([self._source], [], [], patience)[0]:
            return
        data = os.read(self._source, 4096)
        *lines, self._rest = (self._rest + data).split(b"\n")
        if not data:
            self._open = False
            lines, self._rest = [self._rest] if self._rest else [], b""
        self._lines.extend(line.decode(errors="replace") for line in lines)


def run_lines(
    name: str,
    navigator: NavigationClient,
    stores: StoreChoice,
    limits: BatchTimeouts,
    recording: Saving,
    saving: MapSaving | None,
    ended: threading.Event,
    clock: Callable[[], float],
    *,
    attended: bool,
    source: int = 0,
) -> int:
    """Run commands line by line; `attended`: a user types them on a terminal that cannot draw. Returns the exit code.

    A program that reads the output may end: the batch ends then, and with it a goal that is driven to.
    """
    lines, output = LineReader(source, ended), _Output(ended)
    urgent = lines.pop_urgent if attended else None
    around = BatchContext(output.write, _write_err, clock, ended.wait, recording, urgent, saving)
    if attended:
        around.out(f"{name}: one command a line; ? lists them, s stops, e is the emergency stop, q quits")
    try:
        try:
            missing = wait_until_ready(navigator, limits, around)
        except InterruptedBatchError:
            return 128 + signal.SIGINT  # there was no goal yet
        if missing is not None:
            around.err(f"error: {name}: still waiting for {missing} after {limits.start:g} s")
            around.err("  help: 'ur run keyboard_navigate' starts all of it; parameter ~start_timeout sets the limit")
            return 2
        while (store := stores.store_for(navigator.snapshot())) is None:
            if ended.wait(0.1):
                return 128 + signal.SIGINT
        code = run_batch(lines, navigator, store, limits, around)
        return BROKEN_PIPE_EXIT_CODE if output.lost else code
    except InterruptedBatchError as interrupt:
        if output.lost:
            return BROKEN_PIPE_EXIT_CODE
        around.err(f"error: {name}: interrupted{f', {interrupt}' if str(interrupt) else ''}")
        return 1


class _Output:
    """Standard output. When its reader has ended, `ended` is set."""

    def __init__(self, ended: threading.Event) -> None:
        self._ended = ended
        self.lost = False

    def write(self, line: str) -> None:
        try:
            sys.stdout.write(line + "\n")
            sys.stdout.flush()
        except BrokenPipeError:
            self.lost = True
            drop_output()
            self._ended.set()


def _write_err(line: str) -> None:
    sys.stderr.write(line + "\n")
