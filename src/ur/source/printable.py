r"""Untrusted text on a terminal or in a document: control characters are shown as escapes.

File names, launch files, announcements and robots' answers are untrusted. `printable` is for one field of a line,
`one_line` for text that is shown on one line, `printable_lines` for a text of several lines; `GuardedStream` for all
output to an open stream. A control character appears as Python writes it: `\x1b`, `\n`, `\u202e`.
"""

import os
import re
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TextIO, cast

# C0, DEL, C1; marks that turn the direction of text around; line separators; halves of characters (bytes not in UTF-8).
_ACTIVE = "\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff"
# Patterns as texts: most commands print nothing that acts, and compiling these takes a fiftieth of their start.
_FIELD = f"[{_ACTIVE}]"
_LINES = f"[{_ACTIVE}]".replace("\x00-\x1f", "\x00-\x08\x0b-\x1f")
# Written by our own tables, tests and live views: colours, moves of the cursor, erasing (ECMA-48), a hidden cursor and
# the other screen. What makes a terminal answer, report the mouse, change its title or fill the clipboard is not among
# them.
_STREAM = rf"(\x1b\[[0-9;:]*[A-HJKSTm]|\x1b\[\?(?:25|1049)[hl]|\r)|{_LINES}"


def printable(text: str) -> str:
    """Escape control characters in one field of a line. Other texts are returned unchanged."""
    return text if text.isprintable() else re.sub(_FIELD, _escape, text)


def printable_lines(text: str) -> str:
    """Escape control characters in a text, except line breaks and tabs."""
    return text if text.isprintable() else re.sub(_LINES, _escape, text)


def one_line(text: str) -> str:
    """Return a text on one line, with a space in place of each control character."""
    return " ".join("".join(each if each.isprintable() else " " for each in text).split())


class OutputLost(Exception):  # noqa: N818 - says what happened
    """Standard output cannot be written: a full disk, a closed descriptor, or a reader that has ended."""

    def __init__(self, reason: OSError) -> None:
        super().__init__(str(reason))
        self.reason = reason


class GuardedStream:
    """A text stream that escapes control sequences, except for colours, moves of the cursor and erasing.

    Other attributes are those of the stream: `buffer` accepts raw bytes.
    """

    def __init__(self, stream: TextIO, *, essential: bool = False) -> None:
        """Wrap a stream.

        If it is not `essential`, as standard error is not, output that cannot be written is dropped.
        """
        self._stream = stream
        self._essential = essential

    def write(self, text: str) -> int:
        """Write a text; return the number of its characters."""
        try:
            plain = text.replace("\n", "").isprintable()
            self._stream.write(text if plain else re.sub(_STREAM, _keep_or_escape, text))
        except OSError as problem:
            self._lose(problem)
        return len(text)

    def flush(self) -> None:
        """Write buffered text. Raises OutputLost."""
        try:
            self._stream.flush()
        except OSError as problem:
            self._lose(problem)

    def _lose(self, problem: OSError) -> None:
        # Python writes what waits once more when it ends, and would fail then.
        os.dup2(os.open(os.devnull, os.O_WRONLY), self._stream.fileno())
        if self._essential:
            raise OutputLost(problem) from None

    def writelines(self, lines: Iterable[str]) -> None:
        """Write texts, one after the other."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> object:
        """Return any other attribute from the wrapped stream."""
        return getattr(self._stream, name)


def open_closed_streams() -> None:
    """Open replacements for closed standard output and error, whose descriptors other files would get otherwise."""
    for number, name, flags in ((1, "stdout", os.O_RDONLY), (2, "stderr", os.O_WRONLY)):
        if getattr(sys, name) is None:
            opened = os.open(os.devnull, flags)
            if opened != number:
                os.dup2(opened, number)
                os.close(opened)
            # Standard output is refused, as on a full disk; errors could not be reported.
            setattr(sys, name, os.fdopen(number, "w", encoding="utf-8", closefd=False))


@contextmanager
def guard_output() -> Iterator[None]:
    """Guard standard output and standard error of this process while the context lasts."""
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (
        stream if stream is None else cast("TextIO", GuardedStream(stream, essential=stream is sys.stdout))
        for stream in (sys.stdout, sys.stderr)
    )
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


def _escape(match: re.Match[str]) -> str:
    return ascii(match.group())[1:-1]


def _keep_or_escape(match: re.Match[str]) -> str:
    return match.group(1) or _escape(match)
