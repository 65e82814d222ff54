"""Lines to people: node output on standard output and error, the run's own words on standard error."""

from __future__ import annotations

import os
from collections import deque

_BOLD, _RED, _DIM, _PLAIN = "\x1b[1m", "\x1b[31m", "\x1b[2m", "\x1b[0m"
MOST_HELD = 400  # lines; older ones are in the log files


class Console:
    """Writes whole lines. While it is held (a node owns the screen) it keeps what it has to say for later."""

    def __init__(self, out: int = 1, err: int = 2, *, quiet: bool = False) -> None:
        """Take descriptors for node output and for messages. `quiet` drops messages that are no news."""
        self._out = out
        self._err = err
        self._quiet = quiet
        self._colours = {descriptor: _is_terminal(descriptor) for descriptor in (out, err)}
        self._held: deque[tuple[int, str]] | None = None

    @property
    def is_terminal(self) -> bool:
        """Whether node output goes to a terminal."""
        return self._colours[self._out]

    def show(self, name: str, line: str) -> None:
        """A line that a node printed on standard output."""
        self._show(self._out, name, line)

    def show_error(self, name: str, line: str) -> None:
        """A line that a node printed on standard error."""
        self._show(self._err, name, line)

    def _show(self, descriptor: int, name: str, line: str) -> None:
        head = f"{_BOLD}[{name}]{_PLAIN}" if self._colours[descriptor] else f"[{name}]"
        tail = _PLAIN if "\x1b" in line else ""
        self._write(descriptor, f"{head} {line}{tail}\n")

    def inform(self, text: str) -> None:
        """A message that is good to know, while it is new: dropped while the console is held."""
        if not self._quiet and self._held is None:
            self._write(self._err, self._paint(text, _DIM))

    def warn(self, text: str) -> None:
        """A message that matters."""
        self._write(self._err, self._paint(text, _RED if text.startswith("error") else ""))

    def hold(self) -> None:
        """Keep everything until `release`."""
        if self._held is None:
            self._held = deque(maxlen=MOST_HELD)

    def release(self) -> None:
        """Write what was kept."""
        held, self._held = self._held, None
        for descriptor, text in held or ():
            self._write(descriptor, text)

    def _paint(self, text: str, style: str) -> str:
        return f"{style}{text}{_PLAIN}\n" if style and self._colours[self._err] else f"{text}\n"

    def _write(self, descriptor: int, text: str) -> None:
        if self._held is not None:
            self._held.append((descriptor, text))
            return
        data = text.encode("utf-8", "replace")
        try:
            while data:
                data = data[os.write(descriptor, data) :]
        except OSError:
            return  # nobody reads any more; the log files have it


def _is_terminal(descriptor: int) -> bool:
    try:
        return os.isatty(descriptor)
    except OSError:
        return False
