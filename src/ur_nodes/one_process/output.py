"""Output of a process of many nodes: the lines of their logs, and the output of their threads."""

from __future__ import annotations

import logging
import logging.handlers
import sys
import threading
import time
from typing import TextIO

_LONGEST = 10_000_000  # bytes of a log file; there are two


class NodeOutput:
    """Writes lines of logs: to a file, or where that is empty to the standard output and error, as single nodes do."""

    def __init__(self, file: str) -> None:
        self._file = logging.Logger("nodes")
        if file:
            self._file.addHandler(logging.handlers.RotatingFileHandler(file, maxBytes=_LONGEST, backupCount=1))
        self._kept = bool(file)
        self._out, self._errors = sys.stdout, sys.stderr

    def write_line(self, level: str, node: str, text: str) -> None:
        """Write a line of a node's log."""
        line = f"[{level}] [{time.time():.3f}] [{node}]: {text}"
        if self._kept:
            self._file.warning(line)
            return
        stream = self._out if level == "INFO" else self._errors
        stream.write(line + "\n")
        stream.flush()

    def divert_threads(self) -> None:
        """Divert the output of all threads except the main one to the log, if it is a file."""
        if self._kept:
            sys.stdout = _ThreadStream(sys.stdout, self)
            sys.stderr = _ThreadStream(sys.stderr, self)


class _ThreadStream:
    """A stream of the terminal for the main thread, and a log for others."""

    def __init__(self, stream: TextIO, output: NodeOutput) -> None:
        self._stream, self._output = stream, output

    def write(self, text: str) -> int:
        """Write a text."""
        if threading.current_thread() is threading.main_thread():
            return self._stream.write(text)
        for line in filter(None, text.splitlines()):
            self._output.write_line("INFO", threading.current_thread().name, line)
        return len(text)

    def flush(self) -> None:
        """Flush the terminal."""
        self._stream.flush()

    def __getattr__(self, name: str) -> object:
        return getattr(self._stream, name)
