"""Rates and bandwidths of topics over the last seconds."""

from __future__ import annotations

from collections import deque

SPAN = 3.0
"""Seconds over which is measured."""

_MOST = 2000  # messages that are counted one by one


class RateMeter:
    """Counts messages of one topic. Times are seconds of any steady clock."""

    def __init__(self, began: float) -> None:
        self._began = began
        self._seen: deque[tuple[float, int]] = deque(maxlen=_MOST)

    def note(self, now: float, size: int) -> None:
        """Count a message of `size` bytes."""
        self._seen.append((now, size))

    def measure(self, now: float) -> tuple[float, float]:
        """Return messages per second and bytes per second."""
        while self._seen and self._seen[0][0] < now - SPAN:
            self._seen.popleft()
        full = len(self._seen) == _MOST
        span = max(now - self._seen[0][0], 1e-3) if full else max(min(SPAN, now - self._began), 0.5)
        return len(self._seen) / span, sum(size for _, size in self._seen) / span
