"""Output of nodes, to log files and line by line to the user."""

import os
import time
from collections import deque
from collections.abc import Callable

LONGEST_LINE = 16 * 1024  # bytes; a longer one is cut into pieces
KEPT_LINES = 12  # of each node, for crash reports
MOST_READ = 64 * 1024  # bytes at once: what a pipe holds, pipe(7)
FLOOD_PIPE = 1024 * 1024  # bytes to which the pipe of a flooding node is enlarged, if permitted
FLOOD_PAUSE = 0.1  # s between two reads of such a pipe
MOST_SHOWN = 5000  # lines of one node that are displayed at once
MORE_SHOWN = 1000  # and from then on in each period
PERIOD = 2.0  # s


class LineSplitter:
    """Splits bytes into complete lines, without line breaks. Feed b"" at the end for the remainder."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> list[bytes]:
        """Return the lines that are now complete."""
        if not data:
            rest, self._rest = self._rest, b""
            return [rest] if rest else []
        *lines, self._rest = (self._rest + data).split(b"\n")
        while len(self._rest) > LONGEST_LINE:
            lines.append(self._rest[:LONGEST_LINE])
            self._rest = self._rest[LONGEST_LINE:]
        return [line.rstrip(b"\r") for line in lines]

    def skip(self, data: bytes, kept: int) -> tuple[int, list[bytes]]:
        """Return the number of lines that are now complete, and the last `kept` of them; the others are cheap."""
        count = data.count(b"\n")
        if count <= kept:
            lines = self.feed(data)
            return len(lines), lines[-kept:]
        _, *lines, self._rest = data.rsplit(b"\n", kept + 1)
        rest, self._rest = self._rest, b""
        return count + len(self.feed(rest) if rest else ()), [line.rstrip(b"\r") for line in lines]


class Allowance:
    """Limit of the displayed lines of one node: `most`, and `more` after each period, since no user reads more."""

    def __init__(self, most: int = MOST_SHOWN, more: int = MORE_SHOWN, period: float = PERIOD) -> None:
        self._most, self._more, self._period = most, more, period
        self._end, self._left, self._lost = 0.0, most, 0

    def spend(self, count: int, now: float) -> tuple[int, int]:
        """Request a number of lines at a time (s); return the granted number, and the lines lost in the last period."""
        lost = 0
        if now >= self._end:
            periods = 1 + int((now - self._end) / self._period)
            self._end, self._left = now + self._period, min(self._most, self._left + periods * self._more)
            lost, self._lost = self._lost, 0
        granted = min(count, self._left)
        self._left -= granted
        self._lost += count - granted
        return granted, lost

    def is_spent(self, now: float) -> bool:
        """True while no line is granted."""
        return not self._left and now < self._end

    def settle(self) -> int:
        """Return the number of lost lines since the last report, and reset it."""
        lost, self._lost = self._lost, 0
        return lost


class Stream:
    """One pipe or pseudo terminal that a node writes to: all output is logged, and `show(name, line)` gets each line.

    For a node that floods, `show` gets a readable number of lines, and the number of omitted ones.
    """

    def __init__(
        self,
        name: str,
        descriptor: int,
        log: int,
        show: Callable[[str, str], None],
        read_clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.name = name
        self.descriptor = descriptor
        self._log = log
        self._show = show
        self._read_clock = read_clock
        self._lines = LineSplitter()
        self._allowance = Allowance()
        self._buffer = bytearray()  # of a node that floods
        self._about = ""  # or a word: the number of omitted lines is an estimate
        self.may_pause = False  # the node floods, and its pipe holds the output of FLOOD_PAUSE
        os.set_blocking(descriptor, False)

    def read(self, recent: deque[str]) -> bool:
        """Read available output; the last lines are also appended to `recent`. False at the end of the stream."""
        now = self._read_clock()
        self.may_pause = False
        if self._allowance.is_spent(now):
            return self._read_flood(recent, now)
        try:
            data = os.read(self.descriptor, MOST_READ)
        except BlockingIOError:
            return True
        except OSError:  # EIO: the other end of a pseudo terminal is closed
            data = b""
        if data:
            write_log(self._log, data)
        lines = self._lines.feed(data)
        granted, lost = self._allowance.spend(len(lines), now)
        self._describe_lost(lost)
        for line in lines[:granted]:
            text = make_printable(line)
            recent.append(text)
            self._show(self.name, text)
        if granted < len(lines):
            recent.extend(map(make_printable, lines[granted:][-KEPT_LINES:]))
        if not data:
            self._describe_lost(self._allowance.settle())
        return bool(data)

    def _read_flood(self, recent: deque[str], now: float) -> bool:
        """Read while no line is displayed: lines are counted, in a reused buffer, or estimated by the last ones."""
        if not self._buffer:
            self._buffer = bytearray(max(MOST_READ, enlarge_pipe(self.descriptor)))
        try:
            size = os.readv(self.descriptor, [self._buffer])
        except BlockingIOError:
            return True
        except OSError:
            size = 0
        if not size:
            rest = self._lines.feed(b"")
            recent.extend(map(make_printable, rest))
            self._describe_lost(self._allowance.settle() + len(rest))
            return False
        begin = max(0, size - LONGEST_LINE)
        write_log(self._log, memoryview(self._buffer)[:size])
        count, lines = self._lines.skip(bytes(self._buffer[begin:size]), KEPT_LINES)
        if begin and count > KEPT_LINES:  # enough for an estimate; to count all would take longer than to write them
            self._about, count = "about ", count * size // (size - begin)
        elif begin:
            count += self._buffer.count(b"\n", 0, begin)
        self._allowance.spend(count, now)
        recent.extend(map(make_printable, lines))
        # A third of the pipe's capacity and more must be free, so that the node does not block.
        self.may_pause = MOST_READ < len(self._buffer) > 1.6 * size
        return True

    def _describe_lost(self, count: int) -> None:
        if count:
            self._show(self.name, f"... {self._about}{count} lines are not shown here; the log file has them")

    def close(self) -> None:
        """Close the descriptor. The log belongs to the node and stays open."""
        os.close(self.descriptor)


def enlarge_pipe(descriptor: int) -> int:
    """Enlarge a pipe to FLOOD_PIPE bytes; return its capacity, 0 for a descriptor that is no pipe, or on refusal."""
    import fcntl  # only for a node that floods

    try:
        return int(fcntl.fcntl(descriptor, 1031, FLOOD_PIPE))  # F_SETPIPE_SZ, which Python 3.10 knows by number only
    except OSError:
        return 0


def write_log(descriptor: int, data: bytes | memoryview) -> None:
    """Append to a log file. A full disk loses lines, not the run."""
    try:
        os.write(descriptor, data)
    except OSError:
        return


def make_printable(line: bytes) -> str:
    """Return a line for display: colours stay; other control characters, such as cursor moves, become `?`."""
    text = line.decode("utf-8", "replace")
    if text.isprintable():
        return text
    kept = []
    index = 0
    while index < len(text):
        character = text[index]
        if character == "\x1b":
            end = _colour_end(text, index)
            if end:
                kept.append(text[index:end])
                index = end
                continue
        kept.append(character if character.isprintable() or character == "\t" else "?")
        index += 1
    return "".join(kept)


def _colour_end(text: str, start: int) -> int:
    # ESC [ digits and semicolons m: ECMA-48 SGR
    index = start + 2
    if text[start + 1 : start + 2] != "[":
        return 0
    while index < len(text) and text[index] in "0123456789;":
        index += 1
    return index + 1 if text[index : index + 1] == "m" else 0


def read_last_lines(path: str, count: int = KEPT_LINES, most: int = 16 * 1024) -> list[str]:
    """Return the last lines of a log file; empty if it does not exist."""
    try:
        with open(path, "rb") as file:  # noqa: PTH123 - pathlib is not worth its import here
            file.seek(0, os.SEEK_END)
            file.seek(max(0, file.tell() - most))
            data = file.read()
    except OSError:
        return []
    return [make_printable(line.rstrip(b"\r")) for line in data.rstrip(b"\n").split(b"\n")[-count:] if line]
