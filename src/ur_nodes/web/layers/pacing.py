"""Pacing of work within a step that is called often."""

import math


class Every:
    """Work that is due at once, then once in a number of seconds; a late step does not delay later ones."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._next = -math.inf

    def due(self, now: float) -> bool:
        """Return whether the work is due, and if so count it as done. `now` is `Node.steady`."""
        late = now - self._next
        if late < 0.0:
            return False
        self._next = (self._next if late < self._seconds else now) + self._seconds
        return True

    def hurry(self) -> None:
        """Make the work due at once."""
        self._next = -math.inf
