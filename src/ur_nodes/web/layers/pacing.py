"""Work that a step which is called often does from time to time."""

from __future__ import annotations

import math


class Every:
    """Work that is due at once, and then at most once in a number of seconds."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._next = -math.inf

    def due(self, now: float) -> bool:
        """Return whether the work is to be done now, and count the seconds anew if so. `now` is time.monotonic()."""
        if now < self._next:
            return False
        self._next = now + self._seconds
        return True

    def hurry(self) -> None:
        """Have the work due at once."""
        self._next = -math.inf
