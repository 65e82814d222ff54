"""The memory of an exploration: frontiers that could not be reached or seen, until the map changes there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ur_nodes.exploration.reasons import Reason
from ur_nodes.exploration.search.floor import Floor
from ur_nodes.exploration.search.frontiers import Frontier

_SAME = 0.6  # m: frontiers nearer than this are one and the same
_AROUND = 1.0  # m: a change of the map this near to a frontier makes it worth another attempt
_CHANGED = 0.15  # m2


@dataclass(frozen=True, slots=True)
class Attempt:
    """A frontier that was driven to. `looks`: how often its place was reached; `failures`: how often not.

    `reason` is None unless it is given up; `known` is the known space near it at the last of these, m2.
    """

    place: tuple[float, float]
    looks: int = 0
    failures: int = 0
    reason: Reason | None = None
    known: float = 0.0


@dataclass(frozen=True, slots=True)
class AttemptMemory:
    """Attempts, one for a frontier. Each method returns a new memory."""

    attempts: tuple[Attempt, ...] = ()

    def find(self, place: tuple[float, float]) -> Attempt:
        """The attempt at the frontier at a place; a fresh one when there was none."""
        near = [each for each in self.attempts if math.dist(each.place, place) < _SAME]
        return min(near, key=lambda each: math.dist(each.place, place)) if near else Attempt(place)

    def note(self, attempt: Attempt) -> AttemptMemory:
        """Put an attempt in the place of the one before it."""
        old = self.find(attempt.place)
        return AttemptMemory((*(each for each in self.attempts if each is not old), attempt))

    def look(self, place: tuple[float, float], floor: Floor | None) -> AttemptMemory:
        """The robot was where the frontier should be in sight."""
        old = self.find(place)
        known = known_space(floor, old.place) if floor else 0.0
        return self.note(replace(old, looks=old.looks + 1, known=known))

    def fail(self, place: tuple[float, float], reason: Reason, floor: Floor | None) -> AttemptMemory:
        """The robot did not get there."""
        old = self.find(place)
        known = known_space(floor, old.place) if floor else 0.0
        return self.note(replace(old, failures=old.failures + 1, reason=reason, known=known))

    def refresh(self, floor: Floor) -> AttemptMemory:
        """Begin anew where the map has changed: a frontier that moves on as it is looked at is not a stubborn one."""
        return AttemptMemory(tuple(_refreshed(each, floor) for each in self.attempts))

    def retry(self, most: int) -> AttemptMemory:
        """Allow another attempt at what has failed less than `most` times."""
        return AttemptMemory(
            tuple(
                replace(each, reason=None)
                if each.reason and each.reason.kind == "failed" and each.failures < most
                else each
                for each in self.attempts
            )
        )

    def refused(self, frontier: Frontier) -> Reason | None:
        """Return why a frontier is not tried now; None when it is."""
        return self.find(frontier.place).reason


def known_space(floor: Floor, place: tuple[float, float]) -> float:
    """The known space near a place, m2; floor and obstacles."""
    row, column = floor.cell(*place)
    reach = math.ceil(_AROUND / floor.resolution)
    rows, columns = (slice(max(0, at - reach), max(0, at + reach + 1)) for at in (row, column))
    return float(np.count_nonzero(~floor.unknown[rows, columns])) * floor.resolution**2


def _refreshed(attempt: Attempt, floor: Floor) -> Attempt:
    if abs(known_space(floor, attempt.place) - attempt.known) < _CHANGED:
        return attempt
    return Attempt(attempt.place)
