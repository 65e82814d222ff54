"""The last lines that the nodes of a run have printed, numbered, so that each page continues where it was."""

from __future__ import annotations

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
    """A line: the node that has printed it, or "" for the run itself, and its severity, "" where it has none."""

    node: str
    severity: str
    text: str


class LogLines:
    """The last lines of a run. Numbers of lines begin with 0 and have no gaps."""

    def __init__(self, kept: int = KEPT) -> None:
        self._lines: deque[RunLogLine] = deque(maxlen=kept)
        self._next = 0

    def add(self, node: str, severity: str, text: str) -> None:
        """Take a line; what is not text in it is removed or shown as an escape."""
        clean = printable(strip_styles(text).replace("\t", "    "))
        self._lines.append(RunLogLine(node, severity, clean[:_LONGEST]))
        self._next += 1

    @property
    def end(self) -> int:
        """The number of the next line."""
        return self._next

    def since(self, number: int, most: int) -> tuple[int, list[RunLogLine]]:
        """At most `most` lines from a number on, and the number of the first of them: later where lines are lost."""
        first = min(max(number, self._next - len(self._lines)), self._next)
        skipped = first - (self._next - len(self._lines))
        return first, [self._lines[skipped + index] for index in range(min(most, self._next - first))]


def read_lines(path: str, offset: int = 0) -> tuple[list[str], int]:
    """Return the whole lines of a log file from an offset on, and the offset at which they end.

    At most the last 16 KiB, from a whole line on; none where the file cannot be read.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        try:
            size = os.fstat(descriptor).st_size
            begin = offset if 0 < offset <= size else 0  # a file that has become shorter begins anew
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
