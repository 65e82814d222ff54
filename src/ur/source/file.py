"""A text file and positions in it."""

from bisect import bisect_right
from typing import NamedTuple


class Position(NamedTuple):
    """A position between two characters. Line and column count from 1, columns in characters."""

    line: int
    column: int


class SourceFile:
    """A text and the path that it was read from. Equality is identity: spans of one text share one object."""

    __slots__ = ("_line_starts", "path", "text")

    def __init__(self, path: str, text: str) -> None:
        self.path = path
        self.text = text
        self._line_starts: list[int] | None = None

    def __repr__(self) -> str:
        return f"SourceFile({self.path!r})"

    def position(self, offset: int) -> Position:
        """Return line and column of a character offset (0-based; the end of the text is allowed)."""
        starts = self.line_starts()
        line = bisect_right(starts, offset)
        return Position(line, offset - starts[line - 1] + 1)

    def offset_of_line(self, number: int) -> int:
        """Return the offset at which a line (1-based) begins."""
        return self.line_starts()[number - 1]

    def line(self, number: int) -> str:
        """Return the text of a line (1-based) without its line break."""
        starts = self.line_starts()
        end = starts[number] if number < len(starts) else len(self.text)
        return self.text[starts[number - 1] : end].rstrip("\r\n")

    def line_starts(self) -> list[int]:
        """Return the offsets at which the lines begin; the list must not be changed."""
        if self._line_starts is None:
            starts = [0]
            index = self.text.find("\n")
            while index != -1:
                starts.append(index + 1)
                index = self.text.find("\n", index + 1)
            self._line_starts = starts
        return self._line_starts


class Span(NamedTuple):
    """Characters `start` up to `end` (exclusive, 0-based offsets) of a file."""

    file: SourceFile
    start: int
    end: int

    @property
    def position(self) -> Position:
        """Return its start, as line and column."""
        return self.file.position(self.start)

    @property
    def text(self) -> str:
        """Return the characters themselves."""
        return self.file.text[self.start : self.end]

    def __str__(self) -> str:
        line, column = self.position
        return f"{self.file.path}:{line}:{column}"
