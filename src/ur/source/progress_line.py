"""One line on the terminal about the present work of a command, while it prints nothing else."""

import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TextIO, cast

from ur.source.printable import printable
from ur.source.progress import Progress, no_progress

QUIET = 2.0  # s of silence before the line appears
PERIOD = 0.25  # s between updates of the line
PLAIN_PERIOD = 15.0  # s between lines on a terminal that cannot erase
_WIDTH = 80
_ERASE = "\r\x1b[K"


@contextmanager
def show_progress(text: str, *, quiet: float = QUIET) -> Iterator[Progress]:
    """Show the present work on standard error after `quiet` seconds without output, while the context lasts.

    Yields a function that sets the text. The line is erased before any other output to standard output or standard
    error, and at the end. A terminal that cannot erase (TERM=dumb) gets a new line now and then. Nothing is shown if
    standard error is not a terminal, or outside of the main thread. Do not ask questions inside. Inside of another such
    context, the text replaces that of the outer one.
    """
    out = sys.stderr
    if out is None or not out.isatty() or threading.current_thread() is not threading.main_thread():
        yield no_progress
        return
    if isinstance(out, _Watched):
        with out.line.replaced(text) as report:
            yield report
        return
    line = ProgressLine(out, text, quiet, os.environ)
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (cast("TextIO", _Watched(stream, line)) for stream in before)
    over = threading.Event()

    def watch() -> None:
        while not over.wait(PERIOD):
            line.show()

    thread = threading.Thread(target=watch, name="progress", daemon=True)
    thread.start()
    try:
        yield line.report
    finally:
        over.set()
        thread.join()
        line.erase()
        sys.stdout, sys.stderr = before


class ProgressLine:
    """The line itself: drawn by `show` when it is due, erased by other output. Thread-safe."""

    def __init__(
        self,
        out: TextIO,
        text: str,
        quiet: float,
        environment: Mapping[str, str],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Create the line for the terminal `out`, with the first text and the seconds of silence before it is shown."""
        self._out, self._text, self._quiet, self._clock = out, text, quiet, clock
        self._plain = environment.get("TERM", "dumb") in ("dumb", "")
        self._began = self._latest = clock()
        self._drawn = ""  # what is on the screen now
        self._at_start = True  # nothing else stands in the terminal's line
        self._lock = threading.Lock()

    def report(self, text: str) -> None:
        """Set the text."""
        self._text = text

    @contextmanager
    def replaced(self, text: str) -> Iterator[Progress]:
        """Replace the text while the context lasts."""
        before, self._text = self._text, text
        try:
            yield self.report
        finally:
            self._text = before

    def show(self) -> None:
        """Draw the line if it is due and has changed."""
        with self._lock:
            now = self._clock()
            due = now - self._latest >= self._quiet
            if not due or not self._at_start or not _is_in_front(self._out):
                return
            line = f"{printable(self._text)} ({now - self._began:.0f} s)"
            if self._plain:
                self._write(f"{line}\n")
                self._latest = now + PLAIN_PERIOD - self._quiet
                return
            line = line[: _width(self._out) - 1]
            if line != self._drawn:
                self._write(f"{_ERASE}{line}")
                self._drawn = line

    def erase(self) -> None:
        """Erase the line."""
        with self._lock:
            self._erase()

    def write(self, stream: TextIO, text: str) -> int:
        """Write other output to a terminal, in place of the line."""
        with self._lock:
            self._erase()
            written = stream.write(text)
            if text:
                self._latest = self._clock()
                self._at_start = text.endswith("\n")
            return written

    def _erase(self) -> None:
        if self._drawn:
            self._write(_ERASE)
            self._drawn = ""

    def _write(self, text: str) -> None:
        self._out.write(text)
        self._out.flush()


class _Watched:
    """A stream that erases the line before it writes."""

    def __init__(self, stream: TextIO, line: ProgressLine) -> None:
        self._stream = stream
        self._is_terminal = stream.isatty()
        self.line = line

    def write(self, text: str) -> int:
        return self.line.write(self._stream, text) if self._is_terminal else self._stream.write(text)

    def writelines(self, lines: Iterable[str]) -> None:
        for text in lines:
            self.write(text)

    def __getattr__(self, name: str) -> object:
        return getattr(self._stream, name)


def _is_in_front(out: TextIO) -> bool:
    # A command in the background must not overwrite typed text.
    try:
        return os.tcgetpgrp(out.fileno()) == os.getpgrp()
    except (OSError, ValueError):
        return True  # not the terminal that controls this process


def _width(out: TextIO) -> int:
    try:
        return os.get_terminal_size(out.fileno()).columns or _WIDTH
    except (OSError, ValueError):
        return _WIDTH
