"""Lines for the log."""

from __future__ import annotations

from typing import Protocol


class Log(Protocol):
    """Writes lines for people. With `every`, the lines of one place at most once in so many seconds."""

    def debug(self, text: str) -> None:
        """Log a line that only its authors want to know."""

    def info(self, text: str) -> None:
        """Log an event."""

    def warn(self, text: str, *, every: float = 0.0) -> None:
        """Log a line on something that may be wrong."""

    def error(self, text: str, *, every: float = 0.0) -> None:
        """Log a line on something that is wrong."""
