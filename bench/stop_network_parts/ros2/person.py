"""The person at a commander, who follows the patterns that are ordered on standard input."""

import os
import struct
import sys
import threading
import time
from collections.abc import Mapping
from pathlib import Path

from bench.stop_network_parts.lane import Pattern

RECORD = struct.Struct("=dddd")  # of `nursery.read_sent`
PERIOD = 0.05  # s
SPEED = float(os.environ.get("UR_BENCH_SPEED") or 0.5)  # m/s


class Person:
    """Follows a pattern, and notes what is sent."""

    def __init__(self, notes: Path, patterns: Mapping[str, Pattern]) -> None:
        self._file = os.open(notes, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        self._patterns = patterns
        self._pattern: Pattern | None = None
        self._since = 0.0
        threading.Thread(target=self._read, daemon=True).start()

    @property
    def drives(self) -> bool:
        """Return whether there is a pattern to follow."""
        return self._pattern is not None

    def speed(self) -> float:
        """The velocity ahead that is wanted now."""
        pattern = self._pattern
        return SPEED * pattern.sign_at(time.monotonic() - self._since) if pattern else 0.0

    def note(self, speed: float) -> None:
        """Note what is sent now."""
        os.write(self._file, RECORD.pack(time.time(), time.monotonic(), speed, 0.0))

    def _read(self) -> None:
        for line in sys.stdin:
            self._since, self._pattern = time.monotonic(), self._patterns.get(line.strip())
