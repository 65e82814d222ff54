"""The time that ages are measured in, and waiting for a moment of it."""

from __future__ import annotations

import threading
from collections.abc import Callable

_POLL = 0.005  # s: simulated time cannot be waited for


class Clock:
    """Seconds by `read`. `steady` says whether they pass like real ones; those of a simulation may not."""

    def __init__(self, read: Callable[[], float], *, steady: bool) -> None:
        self.read = read
        self._steady = steady

    def wait(self, condition: threading.Condition, until: float) -> None:
        """Give `condition` (which is held) back until it is notified or the moment `until` may have come."""
        left = until - self.read()
        if left > 0.0:
            condition.wait(None if left == float("inf") else left if self._steady else min(left, _POLL))
