"""The terminal as Textual's screen: nothing else writes on it."""

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TextIO

from textual.drivers.linux_driver import LinuxDriver


@contextlib.contextmanager
def own_screen(log: Path) -> Iterator[type[LinuxDriver]]:
    """Make a Textual driver that draws on standard output's terminal, while file descriptor 2 is written to `log`.

    Errors that Python, C++ or a library prints would otherwise land in the picture.
    """
    screen = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    errors = os.dup(2)
    sys.stderr.flush()
    try:
        log.parent.mkdir(parents=True, exist_ok=True)
        sink = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    except OSError:
        sink = os.open(os.devnull, os.O_WRONLY)
    os.dup2(sink, 2)
    os.close(sink)
    try:
        yield _driver_on(screen)
    finally:
        sys.stderr.flush()
        os.dup2(errors, 2)
        os.close(errors)
        with contextlib.suppress(OSError):
            screen.close()


def _driver_on(screen: TextIO) -> type[LinuxDriver]:
    class ScreenDriver(LinuxDriver):
        def __init__(self, *args: Any, **options: Any) -> None:
            super().__init__(*args, **options)
            self._file = screen  # type: ignore[assignment]  # Textual's own is sys.__stderr__, a TextIO too

    return ScreenDriver
