"""States of bumpers, from a driver that reports only the pressed ones."""

from __future__ import annotations

import math
from collections.abc import Iterable

HOLD = 0.5  # s; a driver that looks five times a second may take that long to speak again


class BumperStates:
    """The bumpers of a base, by name."""

    def __init__(self, names: Iterable[str]) -> None:
        self._pressed = dict.fromkeys(names, -math.inf)
        self._told: dict[str, bool] = {}

    def press(self, name: str, time: float) -> None:
        """A bumper is said to be pressed at a time (s). Names that the base does not have are ignored."""
        if name in self._pressed:
            self._pressed[name] = time

    def changes(self, time: float) -> dict[str, bool]:
        """Those whose state at a time (s) is not what the last call said; all of them at the first call."""
        now = {name: 0.0 <= time - pressed <= HOLD for name, pressed in self._pressed.items()}
        changed = {name: state for name, state in now.items() if self._told.get(name) is not state}
        self._told = now
        return changed
