"""Work that a step which is called often does from time to time."""

from __future__ import annotations

import math


class Every:
    """Work that is due at once, and then once in a number of seconds: a step that is late delays no later one."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._next = -math.inf

    def due(self, now: float) -> bool:
        """Return whether the work is to be done now, and count it as done if so. `now` is `Node.steady`."""
        late = now - self._next
        if late < 0.0:
            return False
        self._next = (self._next if late < self._seconds else now) + self._seconds
        return True

    def hurry(self) -> None:
        """Have the work due at once."""
        self._next = -math.inf
