"""The terminal as Textual's screen: nothing else writes on it, and its background is known."""

from __future__ import annotations

import contextlib
import os
import re
import select
import sys
import termios
import time
import tty
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, TextIO

from textual.drivers.linux_driver import LinuxDriver

_ASK_BACKGROUND = b"\x1b]11;?\x1b\\\x1b[c"  # every terminal answers the second; then the first is not answered
_BACKGROUND = re.compile(rb"\x1b\]11;rgb:([0-9a-fA-F]+)/([0-9a-fA-F]+)/([0-9a-fA-F]+)")
_ANSWERED = re.compile(rb"\x1b\[\?[0-9;]*c")


@contextlib.contextmanager
def own_screen(log: Path) -> Iterator[type[LinuxDriver]]:
    """A Textual driver that draws on standard output's terminal, while file descriptor 2 goes to `log`.

    Whatever Python, C++ or a library writes to standard error would otherwise land in the picture.
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


def is_light(environment: Mapping[str, str], ask: Callable[[], bool | None]) -> bool:
    """Return whether the terminal's background is light: its answer, else COLORFGBG, else dark."""
    answer = ask()
    if answer is not None:
        return answer
    background = environment.get("COLORFGBG", "").rpartition(";")[2]
    return background in ("7", "15")


def ask_background(source: int, screen: int, limit: float = 0.3) -> bool | None:
    """Ask the terminal whether its background is light (OSC 11); None when it does not say within `limit` s."""
    try:
        before = termios.tcgetattr(source)
    except termios.error:
        return None
    try:
        tty.setcbreak(source, termios.TCSANOW)
        os.write(screen, _ASK_BACKGROUND)
        return parse_background(_read_answer(source, time.monotonic() + limit))
    except OSError:
        return None
    finally:
        termios.tcsetattr(source, termios.TCSANOW, before)


def parse_background(answer: bytes) -> bool | None:
    """Return whether an answer to OSC 11 names a light colour; None when it is no such answer."""
    match = _BACKGROUND.search(answer)
    if match is None:
        return None
    red, green, blue = (int(part, 16) / (16 ** len(part) - 1) for part in match.groups())
    return bool(0.299 * red + 0.587 * green + 0.114 * blue > 0.5)  # luma as in ITU-R BT.601


def _read_answer(source: int, deadline: float) -> bytes:
    answer = b""
    while not _ANSWERED.search(answer):
        left = deadline - time.monotonic()
        if left <= 0 or not select.select([source], [], [], left)[0]:
            break
        answer += os.read(source, 256)
    return answer


def _driver_on(screen: TextIO) -> type[LinuxDriver]:
    class ScreenDriver(LinuxDriver):
        def __init__(self, *args: Any, **options: Any) -> None:
            super().__init__(*args, **options)
            self._file = screen  # type: ignore[assignment]  # Textual's own is sys.__stderr__, a TextIO too

    return ScreenDriver
