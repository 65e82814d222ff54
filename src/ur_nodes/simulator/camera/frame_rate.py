"""Supervision of a camera's frame rate."""

from __future__ import annotations

import math

PAUSE = 1.0  # s without a picture that is due
ENOUGH = 0.9  # of the pictures that are due


class FrameCount:
    """Counts due pictures and drawn ones, over windows of time."""

    def __init__(self, rate: float, window: float = 5.0) -> None:
        """`rate` is in pictures a second; the first `window` (s) is left out, as drawing starts then."""
        self._rate = rate
        self._window = window
        self._begin = self._last = -math.inf
        self._due = self._made = 0
        self._warm = False
        self._warned = False

    def note(self, time: float, *, made: bool) -> str | None:
        """Count a picture that is due at a time (s), drawn or left out.

        Returns a warning, once, if too few are drawn.
        """
        if not 0.0 <= time - self._last <= PAUSE:
            self._begin, self._due, self._made = time, 0, 0  # no subscriber for a while, or time was reset
        self._last = time
        self._due += 1
        self._made += made
        passed = time - self._begin
        if passed < self._window:
            return None
        reached, warm = self._rate * self._made / self._due, self._warm  # few are due while subscribers come and go
        self._begin, self._due, self._made, self._warm = time, 0, 0, True
        if self._warned or not warm or reached >= ENOUGH * self._rate:
            return None
        self._warned = True
        return (
            f"the simulated camera makes {reached:.0f} of the {self._rate:.0f} pictures a second asked for:"
            " this computer draws no faster; the others are left out, everything else keeps its pace"
        )
