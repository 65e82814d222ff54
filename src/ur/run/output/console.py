"""Lines on the terminal: node output on standard output and error, reports of the run on standard error."""

import os
import select
import time
from collections import deque
from collections.abc import Callable

from ur.source.ansi import BOLD, DIM, RED, RESET, allows_colour
from ur.source.printable import printable, printable_lines

MOST_WAITING = 1000  # lines of one source; the log files have them all
PIECE = 4096  # bytes: what a writable pipe takes without blocking, pipe(7)


class Sink:
    """An open file to which output is written without blocking."""

    def __init__(self, descriptor: int, describe_lost: Callable[[int], bytes] | None = None) -> None:
        """Take an open file, and a function that formats the number of lost lines."""
        self.descriptor = descriptor
        self._describe_lost = describe_lost or _describe_lost
        self._lost: dict[str, int] = {}
        self._waiting: dict[str, int] = {}
        self._lines: deque[tuple[str, bytes]] = deque()
        self._rest = b""

    @property
    def waiting(self) -> bool:
        """True while output is pending."""
        if self._lost and not self._lines:
            self._lines.append(("", self._describe_lost(sum(self._lost.values()))))
            self._lost.clear()
        return bool(self._lines or self._rest)

    @property
    def backlog(self) -> int:
        """Number of pending lines."""
        return len(self._lines)

    def put(self, line: bytes, *, important: bool, source: str = "") -> None:
        """Queue a line. If readers are too slow, lines of the source that prints most are dropped."""
        waiting = self._waiting.get(source, 0)
        if waiting >= MOST_WAITING and not important:
            self.flush()
            waiting = self._waiting.get(source, 0)
        if waiting >= MOST_WAITING and not important:
            self._lost[source] = self._lost.get(source, 0) + 1
            return
        if self._lost and (important or source in self._lost):
            self._lines.append(("", self._describe_lost(sum(self._lost.values()))))
            self._lost.clear()
        self._lines.append((source, line))
        self._waiting[source] = waiting + 1

    def flush(self) -> None:
        """Write pending lines without blocking."""
        while self.waiting and _is_writable(self.descriptor, 0.0):
            while self._lines and len(self._rest) < PIECE:
                source, line = self._lines.popleft()
                self._rest += line
                if self._waiting.get(source, 0) > 1:
                    self._waiting[source] -= 1
                else:
                    self._waiting.pop(source, None)
            try:
                self._rest = self._rest[os.write(self.descriptor, self._rest[:PIECE]) :]
            except BlockingIOError:
                return
            except OSError:  # the reader has ended
                self._lines.clear()
                self._waiting.clear()
                self._rest = b""

    def finish(self, limit: float) -> None:
        """Write all pending lines, within a time limit in s."""
        end = time.monotonic() + limit
        self.flush()
        while self.waiting and (left := end - time.monotonic()) > 0 and _is_writable(self.descriptor, left):
            self.flush()


class Console:
    """Writes whole lines without blocking. While it is held (a node owns the screen), it queues important messages."""

    def __init__(self, out: int = 1, err: int = 2) -> None:
        """Take descriptors for node output and for messages."""
        self._out = Sink(out)
        self._err = self._out if _same_file(out, err) else Sink(err)
        self._colours = {
            sink: _is_terminal(sink.descriptor) and allows_colour(os.environ) for sink in (self._out, self._err)
        }
        self._held: list[tuple[Sink, bytes]] | None = None
        self._newest = ""  # what was put last
        self.silent = False  # while another process shows the output

    @property
    def is_terminal(self) -> bool:
        """True where node output goes to a terminal."""
        return self._colours[self._out]

    def calm(self) -> None:
        """Disable colours from now on, on all descriptors."""
        self._colours = dict.fromkeys(self._colours, False)

    def show(self, name: str, line: str) -> None:
        """Print a line that a node printed on standard output."""
        self._show(self._out, name, line)

    def show_error(self, name: str, line: str) -> None:
        """Print a line that a node printed on standard error."""
        self._show(self._err, name, line)

    def inform(self, text: str) -> None:
        """Print a message of momentary interest: dropped while the console is held."""
        if self._held is None:
            self._put(self._err, self._paint(printable_lines(text), DIM), important=True)

    def warn(self, text: str) -> None:
        """Print an important message."""
        self._put(self._err, f"{printable_lines(text)}\n", important=True)

    def fail(self, text: str) -> None:
        """Print an error, given without the `error: ` that is printed before it."""
        self._put(self._err, self._paint(printable_lines(f"error: {text}"), RED), important=True)

    def replace(self, old: str, new: str) -> bool:
        """Change the newest line, which `inform` printed, in place, also while the console is held.

        Returns False if other output followed, the line does not fit, or it cannot be changed at once.
        """
        sink = self._err
        before, after = (self._paint(text, DIM) for text in (old, new))
        if self._newest != before or not self._colours[sink] or sink.waiting or not _is_writable(sink.descriptor, 0.0):
            return False
        try:
            if os.get_terminal_size(sink.descriptor).columns <= len(new):
                return False
            # Text typed below the line stays, and so does the cursor.
            os.write(sink.descriptor, f"\x1b7\x1b[A\r{after.rstrip()}\x1b[K\x1b8".encode())
        except OSError:
            return False
        self._newest = after
        return True

    def hold(self) -> None:
        """Queue all output until `release`."""
        self.finish(0.5)
        if self._held is None:
            self._held = []

    def release(self) -> None:
        """Write the queued output."""
        held, self._held = self._held, None
        for sink, line in held or ():
            sink.put(line, important=True)

    def waiting(self) -> list[int]:
        """Return the descriptors to poll for writing."""
        return [sink.descriptor for sink in self._colours if sink.waiting]

    def flush(self) -> None:
        """Write pending lines without blocking."""
        for sink in self._colours:
            sink.flush()

    def finish(self, limit: float) -> None:
        """Write all pending lines, within a time limit in s."""
        for sink in self._colours:
            sink.finish(limit)

    def _show(self, sink: Sink, name: str, line: str) -> None:
        name = printable(name)
        head = f"{BOLD}[{name}]{RESET}" if self._colours[sink] else f"[{name}]"
        tail = RESET if "\x1b" in line else ""
        self._put(sink, f"{head} {line}{tail}\n", important=False, source=name)

    def _paint(self, text: str, style: str) -> str:
        return f"{style}{text}{RESET}\n" if style and self._colours[self._err] else f"{text}\n"

    def _put(self, sink: Sink, text: str, *, important: bool, source: str = "") -> None:
        if self.silent:
            return
        line = text.encode("utf-8", "replace")
        if self._held is None:
            self._newest = text
        if self._held is not None:
            self._held.append((sink, line))
        else:
            sink.put(line, important=important, source=source)


def _describe_lost(count: int) -> bytes:
    return b"... %d lines are not shown here; the log files have them\n" % count


def _is_terminal(descriptor: int) -> bool:
    try:
        return os.isatty(descriptor)
    except OSError:
        return False


def _is_writable(descriptor: int, patience: float) -> bool:
    poll = select.poll()
    poll.register(descriptor, select.POLLOUT)
    return bool(poll.poll(patience * 1000))


def _same_file(one: int, other: int) -> bool:
    try:
        first, second = os.fstat(one), os.fstat(other)
    except OSError:
        return False
    return (first.st_dev, first.st_ino) == (second.st_dev, second.st_ino)
