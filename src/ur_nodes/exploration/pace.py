"""Estimate of the remaining time of an exploration, from the growth of the map."""

from __future__ import annotations

from dataclasses import dataclass

_WINDOW = 60.0  # s: the growth of the map is measured over so long
_SHORTEST = 30.0  # s: a shorter time gives no estimate
_LEAST = 0.05  # m2/s: slower growth gives no estimate
_APART = 1.0  # s between two samples that are kept

_FACTOR = 2.2
"""The time left over the unknown floor divided by the growth: each frontier hides more than is counted behind it.

Fitted with bench/exploration: of the times left, flats need 0.6 to 2.0 for it, the office 2.1 and the maze 3.4. Half of
the estimates are within a factor of 1.4 of the truth, and nine of ten within 2.8.
"""


@dataclass(frozen=True, slots=True)
class Pace:
    """Known floor (m2) at times (s) of the last minute, oldest first."""

    samples: tuple[tuple[float, float], ...] = ()

    def note(self, now: float, known: float) -> Pace:
        """Add a sample and drop those that are too old; all of them if the time has jumped back."""
        kept = tuple(each for each in self.samples if now - _WINDOW <= each[0] <= now)
        if len(kept) > 1 and kept[-1][0] - kept[-2][0] < _APART:
            kept = kept[:-1]
        return Pace((*kept, (now, known)))

    def seconds_left(self, unknown: float) -> float | None:
        """The time (s) until `unknown` m2 are explored at this pace; None while too little is known about it."""
        if not self.samples or unknown <= 0.0:
            return None
        (began, before), (now, known) = self.samples[0], self.samples[-1]
        seconds = now - began
        if seconds < _SHORTEST or known - before < _LEAST * seconds:
            return None
        return _FACTOR * unknown * seconds / (known - before)
