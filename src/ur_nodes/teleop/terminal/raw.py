"""The terminal in raw mode: keys at once and unechoed, everything restored at the end."""

import contextlib
import os
import select
import termios
import threading
from collections.abc import Iterator, Sequence

from ur.source.ansi import RESET, strip_colours
from ur.tui.screen.query import measure_terminal
from ur_nodes.client.driver_text import DriverRequest
from ur_nodes.client.mux import MuxRequest, MuxView
from ur_nodes.teleop.terminal.keys import KITTY_FLAGS, Key, KeyEvent, decode_keys


class QuitKey:
    """Reads a file descriptor for a `q`. Its end, as that of an empty pipe, does not end the program."""

    def __init__(self, source: int) -> None:
        self._source: int | None = source

    def wait(self, seconds: float, ended: threading.Event) -> bool:
        """Wait for `q` or for `ended`, at most `seconds`; return whether `q` was read."""
        if self._source is None:
            ended.wait(seconds)
        elif select.select([self._source], [], [], seconds)[0]:
            data = os.read(self._source, 1024)
            if b"q" in data:
                return True
            if not data:
                self._source = None
        return False


EMERGENCY_KEYS: dict[str, MuxRequest] = {"space": "stop", "r": "release"}
OBSTACLE_KEY = "g"
DRIVER_KEYS: dict[str, DriverRequest] = {"d": "take", "a": "ask", "y": "grant"}
SAVE_KEY = "s"
RECORDING_KEY = "n"


def mux_request_of(event: KeyEvent) -> MuxRequest | None:
    """Return the request to the mux that a key makes; None for any other key."""
    return EMERGENCY_KEYS.get(_pressed(event))


def obstacle_request_of(event: KeyEvent, view: MuxView) -> MuxRequest | None:
    """Return the request that turns the obstacle stop on or off; None for other keys, or without an obstacle stop."""
    if _pressed(event) != OBSTACLE_KEY or view.obstacles.state == "none":
        return None
    return "obstacles on" if view.obstacles.state == "off" else "obstacles off"


def driver_request_of(event: KeyEvent) -> DriverRequest | None:
    """Return the lease request of a key; None for any other key."""
    return DRIVER_KEYS.get(_pressed(event))


def asks_to_save(event: KeyEvent) -> bool:
    """Return whether a key asks to save the map."""
    return _pressed(event) == SAVE_KEY


def asks_to_save_recording(event: KeyEvent) -> bool:
    """Return whether a key asks to save what has happened."""
    return _pressed(event) == RECORDING_KEY


def _pressed(event: KeyEvent) -> str:
    """Return the name of a key that is pressed without Ctrl; '' for any other event."""
    return event.name if isinstance(event, Key) and event.action == "press" and not event.ctrl else ""


_ESCAPE_WAIT = 0.05  # s: the bytes of a sequence arrive together; ESC that stays alone is the key
ASK_FLAGS = "\x1b[?u"
_ENTER = f"\x1b[?1049h\x1b[?25l\x1b[?1004h\x1b[>{KITTY_FLAGS}u{ASK_FLAGS}"
_LEAVE = f"\x1b[<u\x1b[?1004l\x1b[?25h{RESET}\x1b[?1049l"


class RawTerminal:
    """A terminal in raw mode. Made by `own_terminal`."""

    plain = False
    """True for a terminal that takes lines only: then `show` adds those that are new."""

    def __init__(self, source: int, screen: int, *, colours: bool = True) -> None:
        self._source = source
        self._colours = colours
        self._screen = screen
        self._shown: list[str] = []
        self._size = (0, 0)
        self._rest = b""

    def read(self, timeout: float) -> bytes | None:
        """Bytes that arrived within `timeout` seconds (b'' for none); None when the terminal is closed."""
        if not select.select([self._source], [], [], max(0.0, timeout))[0]:
            return b""
        try:
            return os.read(self._source, 1024) or None
        except OSError:
            return None

    def read_keys(self, timeout: float) -> tuple[KeyEvent, ...] | None:
        """Keys that were pressed within `timeout` seconds, () for none; None when the terminal is closed."""
        data = self.read(min(timeout, _ESCAPE_WAIT) if self._rest else timeout)
        if data is None:
            return None
        events, self._rest = decode_keys(self._rest + data, final=not data)
        return events

    def size(self) -> tuple[int, int]:
        """Return columns and rows, read each time: without a controlling terminal no signal reports a change."""
        return measure_terminal(self._screen) or (80, 24)

    def request_answer(self) -> None:
        """Request an answer from the terminal, which shows that it still exists."""
        self._write(ASK_FLAGS)

    def show(self, lines: Sequence[str], *, again: bool = False) -> None:
        """Show lines from the top; only those that changed are sent, all of them with `again`."""
        if not self._colours:
            lines = [strip_colours(line) for line in lines]
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
        with contextlib.suppress(OSError):  # a terminal that has closed is noticed by read
            while data:
                data = data[os.write(self._screen, data) :]


class PlainTerminal(RawTerminal):
    """A terminal that gets no escape sequence: new lines are added below."""

    plain = True

    def request_answer(self) -> None:
        """Send no request: a plain terminal would not answer."""

    def show(self, lines: Sequence[str], *, again: bool = False) -> None:  # noqa: ARG002 - what is above stays there
        """Add the lines that were not shown the last time."""
        fresh = [line for line in lines if line and line not in self._shown]
        self._shown = list(lines)
        if fresh:
            self._write("".join(f"{line}\r\n" for line in fresh))


@contextlib.contextmanager
def own_terminal(source: int, screen: int, *, plain: bool = False, colours: bool = True) -> Iterator[RawTerminal]:
    """Own the terminal of these two file descriptors; on any exit it is as it was.

    Keys that make signals are read as keys: under roslaunch the program is not in the terminal's foreground
    group, so Ctrl-C would reach others only. Asks for release events of the kitty protocol; terminals that
    do not know it ignore that. With `plain` no escape sequence is sent, without `colours` (NO_COLOR)
    none that names a colour.
    """
    before = termios.tcgetattr(source)
    terminal = PlainTerminal(source, screen) if plain else RawTerminal(source, screen, colours=colours)
    try:
        attributes = [*before[:6], list(before[6])]
        attributes[0] &= ~(termios.IXON | termios.ICRNL | termios.INLCR)
        attributes[3] &= ~(termios.ICANON | termios.ECHO | termios.ISIG | termios.IEXTEN)
        attributes[6][termios.VMIN], attributes[6][termios.VTIME] = 1, 0
        termios.tcsetattr(source, termios.TCSAFLUSH, attributes)
        terminal._write("" if plain else _ENTER)  # noqa: SLF001 - the two are one thing
        yield terminal
    finally:
        terminal._write("" if plain else _LEAVE)  # noqa: SLF001 - the two are one thing
        with contextlib.suppress(termios.error):
            termios.tcsetattr(source, termios.TCSAFLUSH, before)
