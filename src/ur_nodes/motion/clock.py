"""The time that ages are measured in, and waiting for a moment of it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

_POLL = 0.005  # s: simulated time cannot be waited for


def read_steady_time() -> float:
    """Seconds of a clock that is never set and that also runs while the computer sleeps."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)


class Clock:
    """Seconds by `read`. `steady`: they pass at the rate of real ones; those of a simulation may not."""

    def __init__(self, read: Callable[[], float], *, steady: bool) -> None:
        self.read = read
        self.steady = steady

    def wait(self, condition: threading.Condition, until: float) -> None:
        """Give `condition` (which is held) back until it is notified or the moment `until` may have come."""
        left = until - self.read()
        if left > 0.0:
            condition.wait(None if left == float("inf") else left if self.steady else min(left, _POLL))
