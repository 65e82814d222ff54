"""The memory of an exploration: frontiers that could not be reached or seen until the map changes, with reasons."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from skimage.graph import MCP_Geometric

from ur_nodes.exploration.search.floor import Floor
from ur_nodes.exploration.search.frontiers import Frontier

Kind = Literal["narrow", "obstacle", "behind", "apart", "unseen", "failed"]

_THROUGH_UNKNOWN = 30.0  # the cost of a cell, against 1 for a free one
_THROUGH_OBSTACLE = 1000.0


@dataclass(frozen=True, slots=True)
class Reason:
    """The kind of a reason, the place (m) that blocks the way, and a clause for people."""

    kind: Kind
    point: tuple[float, float]
    text: str


def explain_unreachable(floor: Floor, frontier: Frontier, map_walls: np.ndarray | None = None) -> Reason:
    """Explain why the robot can reach no place that sees a frontier.

    `map_walls` (height, width): the occupied cells of the map alone; other occupied ones are obstacles that sensors see
    now.
    """
    narrow = 1.0 / np.maximum(floor.clearance, 0.5 * floor.resolution)
    tight = np.where(floor.clearance > floor.radius, 1.0, 1.0 + narrow**2)
    costs = np.where(floor.free, tight, np.where(floor.unknown, _THROUGH_UNKNOWN, _THROUGH_OBSTACLE))
    goals = np.argwhere(floor.reachable)
    if not len(goals):
        return Reason("apart", frontier.point, "the robot does not know how to get out of its place")
    search = MCP_Geometric(costs)
    totals, _ = search.find_costs([tuple(cell) for cell in frontier.cells.tolist()], find_all_ends=False)
    lengths = totals[goals[:, 0], goals[:, 1]]
    path = np.array(search.traceback(tuple(goals[int(np.argmin(lengths))].tolist())))
    path = path[::-1]  # from the robot's side
    rows, columns = path[:, 0], path[:, 1]
    crossed = floor.occupied[rows, columns]
    if crossed.any():
        place = floor.point(tuple(path[int(np.argmax(crossed))].tolist()))
        if map_walls is not None and not map_walls[rows, columns][crossed].any():
            return Reason("obstacle", place, f"behind an obstacle at {at(place)}")
        return Reason("behind", place, f"behind the glass or through a gap at {at(place)}")
    room = np.where(floor.unknown[rows, columns], np.inf, floor.clearance[rows, columns])
    tightest = int(np.argmin(room))
    place = floor.point(tuple(path[tightest].tolist()))
    # From the centre of one wall's cell to that of the other; half of either cell belongs to the wall.
    width = max(0.0, 2.0 * float(room[tightest]) - floor.resolution)
    if room[tightest] <= floor.radius:
        return Reason("narrow", place, f"too narrow at {at(place)}: {width:.2f} m < {2.0 * floor.radius:.2f} m")
    if floor.unknown[rows, columns].any():
        return Reason("apart", frontier.point, "no known floor leads to it")
    return Reason("unseen", frontier.point, "no place that the robot gets to is in sight of it")


def at(point: tuple[float, float]) -> str:
    """Describe a place of the map in words for users."""
    return f"({point[0]:.2f}, {point[1]:.2f})"


_SAME = 0.6  # m: frontiers nearer than this are one and the same
_AROUND = 1.0  # m: a change of the map this near to a frontier makes it worth another attempt
_CHANGED = 0.15  # m2


@dataclass(frozen=True, slots=True)
class Attempt:
    """A frontier that was driven to. `looks`: how often its place was reached; `failures`: how often not.

    `reason` is None unless it is given up; `known` is the known space near it at the last of these, m2.
    """

    point: tuple[float, float]
    looks: int = 0
    failures: int = 0
    reason: Reason | None = None
    known: float = 0.0


@dataclass(frozen=True, slots=True)
class AttemptMemory:
    """Attempts, one for a frontier. Each method returns a new memory."""

    attempts: tuple[Attempt, ...] = ()

    def find(self, point: tuple[float, float]) -> Attempt:
        """Return the attempt at the frontier at a place; a new one if there was none."""
        near = [each for each in self.attempts if math.dist(each.point, point) < _SAME]
        return min(near, key=lambda each: math.dist(each.point, point)) if near else Attempt(point)

    def note(self, attempt: Attempt) -> AttemptMemory:
        """Replace the earlier attempt at the same frontier."""
        old = self.find(attempt.point)
        return AttemptMemory((*(each for each in self.attempts if each is not old), attempt))

    def look(self, point: tuple[float, float], floor: Floor | None) -> AttemptMemory:
        """Note that the robot reached the place from which the frontier should be visible."""
        old = self.find(point)
        known = known_space(floor, old.point) if floor else 0.0
        return self.note(replace(old, looks=old.looks + 1, known=known))

    def fail(self, point: tuple[float, float], reason: Reason, floor: Floor | None) -> AttemptMemory:
        """Note that the robot did not reach the frontier."""
        old = self.find(point)
        known = known_space(floor, old.point) if floor else 0.0
        return self.note(replace(old, failures=old.failures + 1, reason=reason, known=known))

    def refresh(self, floor: Floor) -> AttemptMemory:
        """Forget attempts where the map has changed: a frontier that recedes when it is seen has not failed."""
        return AttemptMemory(tuple(_refreshed(each, floor) for each in self.attempts))

    def retry(self, most: int) -> AttemptMemory:
        """Allow another attempt at frontiers that have failed less than `most` times."""
        return AttemptMemory(
            tuple(
                replace(each, reason=None)
                if each.reason and each.reason.kind == "failed" and each.failures < most
                else each
                for each in self.attempts
            )
        )

    def refused(self, frontier: Frontier) -> Reason | None:
        """Return the reason why a frontier is not tried now; None if it is."""
        return self.find(frontier.point).reason


def known_space(floor: Floor, point: tuple[float, float]) -> float:
    """The known space near a place, m2; floor and obstacles."""
    row, column = floor.cell(*point)
    reach = math.ceil(_AROUND / floor.resolution)
    rows, columns = (slice(max(0, at - reach), max(0, at + reach + 1)) for at in (row, column))
    return float(np.count_nonzero(~floor.unknown[rows, columns])) * floor.resolution**2


def _refreshed(attempt: Attempt, floor: Floor) -> Attempt:
    if abs(known_space(floor, attempt.point) - attempt.known) < _CHANGED:
        return attempt
    return Attempt(attempt.point)
