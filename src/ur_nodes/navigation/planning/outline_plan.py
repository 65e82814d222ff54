"""Paths that the outline of a long robot fits on: a path is checked, and mended where it touches something."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from skimage.graph import MCP_Geometric

from ur_nodes.costmap.costmap import LETHAL, Costmap
from ur_nodes.costmap.footprint import Footprint, footprint_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.planning.legs import Leg, legs_of_motions
from ur_nodes.navigation.planning.outline_grid import (
    HEADINGS,
    OutlineStamp,
    blocked_headings,
    heading_angle,
    heading_number,
    make_stamp,
    overlaps,
)
from ur_nodes.navigation.planning.outline_motions import MotionPose, Motions, Steering
from ur_nodes.navigation.planning.outline_search import SearchGrid, find_motions
from ur_nodes.navigation.planning.path_geometry import Points, arc_lengths

_LONG, _WIDE = 0.1, 0.4  # m between the radii of a long footprint, and of its greater one: half a narrow door
_BESIDE = 0.05  # m of room that a motion has beside the outline where there is some
_STRAY = 0.03  # m by which the robot may be beside a path that was not searched for the outline
_AROUND = 1.2  # m of a path before and after what touches that are searched again
_MARGIN = 2.0  # m of the map round a path
_ALIKE = 3.0  # cells: others as narrow that are as near belong to the same place
_APART = 0.6  # m: conflicts that are nearer than this are one
_MOST = 3_000  # states of one search
_MOST_WHOLE = 10_000  # of a search for the whole path
_MOST_SHUNTING = 30_000  # likewise, of a robot that cannot turn on the spot


@dataclass(frozen=True, slots=True, eq=False)
class OutlinePath:
    """Legs, and the turn (rad) on the spot at the end, None: the shorter one."""

    legs: tuple[Leg, ...]
    last_turn: float | None = None


def is_long(footprint: Footprint) -> bool:
    """Return whether a path that the inscribed circle fits on may be too narrow for the outline."""
    return footprint.circumscribed > _WIDE and footprint.circumscribed - footprint.inscribed > _LONG


@dataclass(frozen=True, slots=True, eq=False)
class OutlineRequest:
    """A path (n, 2) on a costmap for the outline of a robot at `start`; `heading` is that at its end, None: any.

    `weights` (256) are the costs of a metre, as for `find_cell_path`. `careful`: the robot could not follow the path as
    it is, so its begin is searched anew.
    """

    costmap: Costmap
    weights: NDArray[np.float64]
    points: Points
    footprint: Footprint
    start: Pose2
    heading: float | None
    steering: Steering
    careful: bool = False


def fit_outline(request: OutlineRequest) -> OutlinePath:
    """Mend a path where the outline touches something. What cannot be mended stays as it is.

    For a robot that cannot turn on the spot the whole way is searched; there are no legs when none was found.
    """
    fitting = _Fitting(request)
    return fitting.run() if request.steering.spins else fitting.run_whole()


@lru_cache(maxsize=8)
def _stamps(footprint: Footprint, resolution: float) -> tuple[OutlineStamp, OutlineStamp]:
    return make_stamp(footprint, resolution, 0.0), make_stamp(footprint, resolution, 0.0, _BESIDE)


@lru_cache(maxsize=8)
def _widened(footprint: Footprint, resolution: float) -> Footprint:
    corners = tuple((x, y) for x, y in footprint.outline.tolist())
    return footprint_of_outline(corners, resolution, _STRAY)


class _Fitting:
    """One path. Poses are in the frame of the part of the grid round it: m from its corner, along its axes."""

    def __init__(self, request: OutlineRequest) -> None:
        self._careful, self._weights = request.careful, request.weights
        self._costmap, self._footprint, self._steering = request.costmap, request.footprint, request.steering
        self._points, self._start, self._heading = request.points, request.start, request.heading
        self._poses = np.column_stack((self._points, _tangents(self._points)))

    def run(self) -> OutlinePath:
        path = OutlinePath((Leg(self._points),))
        touching = overlaps(self._poses, self._costmap, _widened(self._footprint, self._costmap.resolution)) > 0
        if not touching.any() and not self._careful and self._turns_are_free():
            return path
        self._cut_out()
        touching[0] |= self._careful or not self._can_turn(self._start, float(self._poses[0, 2]))
        end = Pose2(*self._poses[-1].tolist())
        touching[-1] |= self._heading is not None and not self._can_turn(end, self._heading)
        motions: list[MotionPose] = []
        here = 0
        for first, last in self._conflicts(touching):
            mended = self._mend(first, last, touching)
            if mended is None:
                return self._search_whole(_MOST_WHOLE) or path
            motions += self._motions_of(here, first)
            motions += mended[1:] if motions else mended
            here = last
        motions += self._motions_of(here, len(self._points) - 1)
        return self._result(motions)

    def run_whole(self) -> OutlinePath:
        self._cut_out()
        return self._search_whole(_MOST_SHUNTING) or OutlinePath(())

    def _turns_are_free(self) -> bool:
        """Return whether the turns on the spot at both ends touch nothing, roughly: on the costmap itself."""
        ends = [(self._start, float(self._poses[0, 2]))]
        if self._heading is not None:
            ends.append((Pose2(*self._poses[-1].tolist()), self._heading))
        for pose, yaw in ends:
            difference = math.remainder(yaw - pose.yaw, math.tau)
            steps = np.linspace(0.0, difference, max(2, round(abs(difference) / 0.1)))
            sweep = np.column_stack((np.full((len(steps), 2), pose[:2]), pose.yaw + steps))
            counts = overlaps(sweep, self._costmap, self._footprint)
            if (counts > counts[0]).any():  # at its start it may touch something already
                return False
        return True

    def _cut_out(self) -> None:
        """Work out where the outline fits in the part of the map round the path."""
        costmap = self._costmap
        margin = math.ceil((_MARGIN + self._footprint.circumscribed) / costmap.resolution)
        cells = costmap.cells_of_points(np.concatenate((self._points, [self._start[:2]])))
        low = np.maximum(cells.min(axis=0) - margin, 0)
        high = np.minimum(cells.max(axis=0) + margin + 1, costmap.shape)
        costs = costmap.costs[low[0] : high[0], low[1] : high[1]]
        stamp, wide = _stamps(self._footprint, costmap.resolution)
        self._cells = self._weights[costs]
        self._blocked = blocked_headings(costs == LETHAL, stamp)
        self._narrow = blocked_headings(costs == LETHAL, wide)
        corner = costmap.origin.transform_points(np.array((low[1], low[0]), float)[None] * costmap.resolution)[0]
        self._corner = Pose2(float(corner[0]), float(corner[1]), costmap.origin.yaw)

    def _can_turn(self, pose: Pose2, yaw: float) -> bool:
        """Return whether the shorter turn on the spot to a heading is free."""
        local = self._corner.inverse().compose(pose)
        bits = self._bits(local)
        here = heading_number(local.yaw)
        left = (heading_number(yaw - self._corner.yaw) - here) % HEADINGS
        turns = range(1, left + 1) if left <= HEADINGS // 2 else range(-1, left - HEADINGS - 1, -1)
        return all(not bits >> (here + turn) % HEADINGS & 1 for turn in turns)

    def _bits(self, local: Pose2) -> int:
        row, column = int(local.y / self._costmap.resolution), int(local.x / self._costmap.resolution)
        height, width = self._blocked.shape
        return int(self._blocked[min(max(row, 0), height - 1), min(max(column, 0), width - 1)])

    def _conflicts(self, touching: NDArray[np.bool_]) -> list[tuple[int, int]]:
        """First and last points of the parts of the path that are to be searched anew."""
        along = arc_lengths(self._points)
        parts: list[tuple[int, int]] = []
        for index in np.flatnonzero(touching).tolist():
            first = int(np.searchsorted(along, along[index] - _AROUND))
            last = min(int(np.searchsorted(along, along[index] + _AROUND)), len(along) - 1)
            while first > 0 and touching[first]:
                first -= 1
            while last < len(along) - 1 and touching[last]:
                last += 1
            if parts and first <= parts[-1][1]:
                parts[-1] = (parts[-1][0], last)
            else:
                parts.append((first, last))
        return parts

    def _mend(self, first: int, last: int, touching: NDArray[np.bool_]) -> Motions | None:
        """Search a part of the path anew, through the narrowest poses of it."""
        ends: list[Pose2] = [self._start if first == 0 else Pose2(*self._poses[first].tolist())]
        ends += self._gates(first, last, touching)
        ends.append(Pose2(*self._poses[last].tolist()))
        is_end = last == len(self._points) - 1
        motions: list[MotionPose] = []
        for number, (begin, end) in enumerate(pairwise(ends)):
            final = number == len(ends) - 2
            heading = self._heading if final and is_end else end.yaw
            found = self._search(motions[-1] if motions else begin, end, heading, _MOST)
            if not found:
                return None
            motions += found[1:] if motions else found
        return tuple(motions)

    def _gates(self, first: int, last: int, touching: NDArray[np.bool_]) -> list[Pose2]:
        """The narrowest pose near each conflict: the cell with the fewest free headings on or beside the path."""
        along = arc_lengths(self._points)
        gates: list[Pose2] = []
        numbers = [n for n in np.flatnonzero(touching).tolist() if first < n < last]
        groups: list[list[int]] = []
        for number in numbers:
            if groups and along[number] - along[groups[-1][-1]] < _APART:
                groups[-1].append(number)
            else:
                groups.append([number])
        for group in groups:
            low = max(first + 1, int(np.searchsorted(along, along[group[0]] - 0.3)))
            high = min(last - 1, int(np.searchsorted(along, along[group[-1]] + 0.3)))
            gate = self._narrowest(low, high)
            if gate is not None:
                gates.append(gate)
        return gates

    def _narrowest(self, low: int, high: int) -> Pose2 | None:
        """The middle of the cells with the fewest free headings near points of the path; None where all are free."""
        resolution = self._costmap.resolution
        height, width = self._blocked.shape
        found: dict[tuple[int, int], tuple[int, int]] = {}
        for index in range(low, high + 1):
            local = self._corner.inverse().compose(Pose2(*self._poses[index].tolist()))
            row, column = int(local.y / resolution), int(local.x / resolution)
            for r in range(max(0, row - 2), min(height, row + 3)):
                for c in range(max(0, column - 2), min(width, column + 3)):
                    bits = int(self._blocked[r, c])
                    number = _free_near(bits, heading_number(local.yaw))
                    if number is not None and math.isfinite(self._cells[r, c]):
                        found.setdefault((r, c), (HEADINGS - bits.bit_count(), number))
        if not found:
            return None
        least, number = min(found.values())
        first = next(cell for cell, each in found.items() if each == (least, number))
        alike = [cell for cell, each in found.items() if each == (least, number) and math.dist(cell, first) < _ALIKE]
        if least == HEADINGS:
            return None
        y, x = (np.mean(alike, axis=0) + 0.5) * resolution
        return self._corner.compose(Pose2(float(x), float(y), heading_angle(number)))

    def _search(self, begin: Pose2 | MotionPose, end: Pose2, heading: float | None, most: int) -> Motions:
        inverse = self._corner.inverse()
        here = inverse.compose(Pose2(begin.x, begin.y, begin.yaw))
        goal = inverse.compose(end)
        resolution = self._costmap.resolution
        field = MCP_Geometric(np.where(np.isfinite(self._cells), self._cells, -1.0))
        cell = int(goal.y / resolution), int(goal.x / resolution)
        if not math.isfinite(self._cells[cell]):
            return ()
        totals, _ = field.find_costs([cell])
        local = None if heading is None else heading - self._corner.yaw
        for blocked in (self._narrow, self._blocked):
            grid = SearchGrid(blocked, self._narrow, self._cells, totals * resolution, resolution)
            found = find_motions(grid, (*here,), (goal.x, goal.y, local), self._steering, most=most)
            if found.motions:
                break
        return tuple(MotionPose(*self._corner.compose(Pose2(m.x, m.y, m.yaw)), m.gear) for m in found.motions)

    def _search_whole(self, most: int) -> OutlinePath | None:
        found = self._search(self._start, Pose2(*self._poses[-1].tolist()), self._heading, most)
        return self._result(list(found)) if found else None

    def _motions_of(self, first: int, last: int) -> list[MotionPose]:
        poses = self._poses[first : last + 1].tolist() if last > first else []
        return [MotionPose(x, y, yaw, 1) for x, y, yaw in poses]

    def _result(self, motions: Sequence[MotionPose]) -> OutlinePath:
        legs, turn = legs_of_motions(motions)
        return OutlinePath(legs or (Leg(self._points),), turn if abs(turn) > 0.0 else None)


def _free_near(bits: int, number: int) -> int | None:
    """The middle of the free headings round the one that is nearest, which is at most an eighth of a turn away."""
    for away in range(HEADINGS // 8 + 1):
        for other in ((number + away) % HEADINGS, (number - away) % HEADINGS):
            if not bits >> other & 1:
                left = right = 0
                while left < HEADINGS and not bits >> (other + left + 1) % HEADINGS & 1:
                    left += 1
                while right < HEADINGS and not bits >> (other - right - 1) % HEADINGS & 1:
                    right += 1
                return (other + (left - right) // 2) % HEADINGS
    return None


def _tangents(points: Points) -> NDArray[np.float64]:
    """The direction (n) of a path at its points, over two of them on both sides."""
    count = len(points)
    low, high = np.maximum(np.arange(count) - 2, 0), np.minimum(np.arange(count) + 2, count - 1)
    steps = points[high] - points[low]
    angles: NDArray[np.float64] = np.arctan2(steps[:, 1], steps[:, 0])
    return angles
