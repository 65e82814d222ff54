"""Lines of a pipe or a terminal; urgent commands among them do not wait for their turn."""

from __future__ import annotations

import os
import select
import threading
from collections import deque
from collections.abc import Iterator

from ur.source.diagnostic import UserError
from ur_nodes.teleop.navigate.commands import AskMux, CancelGoal, Command, ContinueGoal, Quit, parse_command

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
        """Take the first urgent command: stop, emergency, release, continue, quit. Never blocks.

        After `quit` no further line is read.
        """
        self._read(0.0)
        for line in self._lines:
            try:
                command = parse_command(line)
            except UserError:
                continue  # it is reported at its turn
            if isinstance(command, (CancelGoal, AskMux, ContinueGoal, Quit)):
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
