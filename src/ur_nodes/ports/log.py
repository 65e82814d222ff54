"""The log of a node."""

import re
from collections.abc import Callable
from typing import Protocol

_NUMBERS = re.compile(r"[\d.]+")
Write = Callable[[str], object]
"""Writes a line."""


class Log(Protocol):
    """Writes lines for users. With `every`, lines that are alike are logged at most once in so many seconds."""

    def debug(self, text: str) -> None:
        """Log a detail for developers."""

    def info(self, text: str) -> None:
        """Log an event."""

    def warn(self, text: str, *, every: float = 0.0) -> None:
        """Log a possible problem."""

    def error(self, text: str, *, every: float = 0.0) -> None:
        """Log an error."""


class ThrottledLog:
    """See Log: writes each line by the function of its level, and reads the time (s) for `every`."""

    def __init__(self, debug: Write, info: Write, warn: Write, error: Write, read: Callable[[], float]) -> None:
        self._debug, self._info, self._warn, self._error = debug, info, warn, error
        self._throttle = Throttle(read)

    def debug(self, text: str) -> None:
        self._debug(text)

    def info(self, text: str) -> None:
        self._info(text)

    def warn(self, text: str, *, every: float = 0.0) -> None:
        if self._throttle.lets(text, every):
            self._warn(text)

    def error(self, text: str, *, every: float = 0.0) -> None:
        if self._throttle.lets(text, every):
            self._error(text)


class Throttle:
    """Limits lines to one in a number of seconds, by the clock `read`."""

    def __init__(self, read: Callable[[], float]) -> None:
        self._read = read
        self._last: dict[str, float] = {}

    def lets(self, text: str, every: float) -> bool:
        """Return whether the line may be written now; with 0 it always may. Lines that differ in numbers are alike."""
        if not every:
            return True
        text = _NUMBERS.sub("0", text)
        now = self._read()
        if 0.0 <= now - self._last.get(text, -every) < every:
            return False
        if len(self._last) > 100:
            self._last.clear()
        self._last[text] = now
        return True
