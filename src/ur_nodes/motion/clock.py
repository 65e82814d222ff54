"""The time that ages are measured in, for nodes that still use rospy."""

from __future__ import annotations

import time


def read_steady_time() -> float:
    """Seconds of a clock that is never set and that also runs while the computer sleeps."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)
