"""The terminal as a program that owns it: keys at once and unechoed, and everything restored at the end."""

from __future__ import annotations

import contextlib
import os
import select
import termios
from collections.abc import Iterator, Sequence
from typing import Any

from ur_nodes.teleop.keys import KITTY_FLAGS

ASK_FLAGS = "\x1b[?u"
_ENTER = f"\x1b[?1049h\x1b[?25l\x1b[?1004h\x1b[>{KITTY_FLAGS}u{ASK_FLAGS}"
_LEAVE = "\x1b[<u\x1b[?1004l\x1b[?25h\x1b[0m\x1b[?1049l"


class Terminal:
    """A terminal in raw mode. Made by `own_terminal`."""

    def __init__(self, source: int, screen: int) -> None:
        self._source = source
        self._screen = screen
        self._shown: list[str] = []
        self._size = (0, 0)

    def read(self, timeout: float) -> bytes | None:
        """Bytes that came within `timeout` seconds (b'' for none); None when the terminal is gone."""
        ready, _, _ = select.select([self._source], [], [], max(0.0, timeout))
        if not ready:
            return b""
        try:
            return os.read(self._source, 1024) or None
        except OSError:
            return None

    def size(self) -> tuple[int, int]:
        """Columns and rows now. Asked each time: without a controlling terminal no signal tells of a change."""
        try:
            columns, rows = os.get_terminal_size(self._screen)
        except OSError:
            return 80, 24
        return (columns, rows) if columns and rows else (80, 24)

    def ask_for_life(self) -> None:
        """Have the terminal answer something, so that one knows it is still there."""
        self._write(ASK_FLAGS)

    def show(self, lines: Sequence[str], *, again: bool = False) -> None:
        """Show lines from the top; only those that changed are sent, all of them with `again`."""
        size = self.size()
        if again or size != self._size:
            self._shown, self._size = [], size
        fresh = not self._shown
        out = ["\x1b[H\x1b[J"] if fresh else []
        for row, line in enumerate(lines):
            if fresh or row >= len(self._shown) or self._shown[row] != line:
                out.append(f"\x1b[{row + 1};1H{line}\x1b[K")
        if len(lines) < len(self._shown):
            out.append(f"\x1b[{len(lines) + 1};1H\x1b[J")
        self._shown = list(lines)
        if out:
            self._write("".join(out))

    def _write(self, text: str) -> None:
        data = text.encode()
        with contextlib.suppress(OSError):  # a terminal that is gone is noticed by read
            while data:
                data = data[os.write(self._screen, data) :]


@contextlib.contextmanager
def own_terminal(source: int, screen: int) -> Iterator[Terminal]:
    """Own the terminal of these two file descriptors; on any exit it is as it was.

    Keys that make signals are read as keys: under roslaunch the program is not in the terminal's foreground
    group, so Ctrl-C would reach others only. Asks for release events of the kitty protocol; terminals that
    do not know it ignore that.
    """
    before = termios.tcgetattr(source)
    terminal = Terminal(source, screen)
    try:
        termios.tcsetattr(source, termios.TCSAFLUSH, _raw(before))
        terminal._write(_ENTER)  # noqa: SLF001 - the two are one thing
        yield terminal
    finally:
        terminal._write(_LEAVE)  # noqa: SLF001 - the two are one thing
        with contextlib.suppress(termios.error):
            termios.tcsetattr(source, termios.TCSAFLUSH, before)


def _raw(before: list[Any]) -> list[Any]:
    attributes = [*before[:6], list(before[6])]
    attributes[0] &= ~(termios.IXON | termios.ICRNL | termios.INLCR)
    attributes[3] &= ~(termios.ICANON | termios.ECHO | termios.ISIG | termios.IEXTEN)
    attributes[6][termios.VMIN], attributes[6][termios.VTIME] = 1, 0
    return attributes
