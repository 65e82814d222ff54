"""What nodes print: to log files and, line by line, to people."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable

LONGEST_LINE = 16 * 1024  # bytes; a longer one is cut into pieces
KEPT_LINES = 12  # of each node, for crash reports


class LineSplitter:
    """Bytes in, complete lines out (without line breaks). Feed b"" at the end for what is left."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> list[bytes]:
        """The lines that are complete now."""
        if not data:
            rest, self._rest = self._rest, b""
            return [rest] if rest else []
        *lines, self._rest = (self._rest + data).split(b"\n")
        while len(self._rest) > LONGEST_LINE:
            lines.append(self._rest[:LONGEST_LINE])
            self._rest = self._rest[LONGEST_LINE:]
        return [line.rstrip(b"\r") for line in lines]


class Stream:
    """One pipe or pseudo terminal that a node writes to; each line goes to the log and to `show(name, line)`."""

    def __init__(self, name: str, descriptor: int, log: int, show: Callable[[str, str], None]) -> None:
        self.name = name
        self.descriptor = descriptor
        self._log = log
        self._show = show
        self._lines = LineSplitter()
        os.set_blocking(descriptor, False)

    def read(self, recent: deque[str]) -> bool:
        """Take what is there; the last lines also go to `recent`. False at the end of the stream."""
        try:
            data = os.read(self.descriptor, 65536)
        except BlockingIOError:
            return True
        except OSError:  # EIO: the other end of a pseudo terminal is closed
            data = b""
        if data:
            write_log(self._log, data)
        for line in self._lines.feed(data):
            text = make_printable(line)
            recent.append(text)
            self._show(self.name, text)
        return bool(data)

    def close(self) -> None:
        """Give the descriptor back. The log belongs to the node and stays open."""
        os.close(self.descriptor)


def write_log(descriptor: int, data: bytes) -> None:
    """Append to a log file. A full disk loses lines, not the run."""
    try:
        os.write(descriptor, data)
    except OSError:
        return


def make_printable(line: bytes) -> str:
    """A line for people: colours stay, whatever else would move the cursor or ring a bell becomes `?`."""
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
    """The last lines of a log file; empty when there is none."""
    try:
        with open(path, "rb") as file:  # noqa: PTH123 - pathlib is not worth its import here
            file.seek(0, os.SEEK_END)
            file.seek(max(0, file.tell() - most))
            data = file.read()
    except OSError:
        return []
    return [make_printable(line.rstrip(b"\r")) for line in data.rstrip(b"\n").split(b"\n")[-count:] if line]
