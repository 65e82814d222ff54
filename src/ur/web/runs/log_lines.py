"""The last output lines of a run's nodes, numbered, so that each page continues after the last line it has."""

import os
from collections import deque
from dataclasses import dataclass

from ur.source.ansi import strip_styles
from ur.source.printable import printable

KEPT = 1000
"""Lines that are kept of a run."""

_TAIL = 1 << 14  # bytes of a log file that are read back
_LONGEST = 1000  # characters of a line


@dataclass(frozen=True, slots=True)
class RunLogLine:
    """A line: the node that printed it, or "" for the run itself, and its severity, or "" if unknown."""

    node: str
    severity: str
    text: str


class LogLines:
    """The last lines of a run. Numbers of lines begin with 0 and have no gaps."""

    def __init__(self, kept: int = KEPT) -> None:
        self._lines: deque[RunLogLine] = deque(maxlen=kept)
        self._next = 0

    def add(self, node: str, severity: str, text: str) -> None:
        """Add a line; characters that are not printable are removed or shown as escapes."""
        clean = printable(strip_styles(text).replace("\t", "    "))
        self._lines.append(RunLogLine(node, severity, clean[:_LONGEST]))
        self._next += 1

    @property
    def end(self) -> int:
        """The number of the next line."""
        return self._next

    def since(self, number: int, most: int) -> tuple[int, list[RunLogLine]]:
        """Return at most `most` lines from a number on, and the number of the first: higher if lines were lost."""
        first = min(max(number, self._next - len(self._lines)), self._next)
        skipped = first - (self._next - len(self._lines))
        return first, [self._lines[skipped + index] for index in range(min(most, self._next - first))]


def read_lines(path: str, offset: int = 0) -> tuple[list[str], int]:
    """Return the whole lines of a log file from an offset on, and the offset at which they end.

    At most the last 16 KiB are read, from a whole line on; the list is empty if the file cannot be read.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        try:
            size = os.fstat(descriptor).st_size
            begin = offset if 0 < offset <= size else 0  # a file that has become shorter is read from its beginning
            cut = size - begin > _TAIL
            begin = size - _TAIL if cut else begin
            data = os.pread(descriptor, _TAIL, begin)
        finally:
            os.close(descriptor)
    except OSError:
        return [], 0
    whole = data[: data.rfind(b"\n") + 1]
    lines = whole.decode("utf-8", "replace").splitlines()
    return lines[1:] if cut else lines, begin + len(whole)
