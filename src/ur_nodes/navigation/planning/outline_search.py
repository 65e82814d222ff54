"""The cheapest motion of a robot's outline among obstacles: a search over place and heading (hybrid A*).

A motion is made of short pieces: straight on, arcs, and, where the robot can, turns on the spot. Places are numbers,
headings are the 64 of `outline_grid`, and of the motions to one cell with one heading the cheapest goes on (Dolgov,
Thrun, Montemerlo, Diebel: Practical search techniques in path planning for autonomous driving, 2008).
"""

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ur_nodes.navigation.planning.outline_grid import HEADINGS, STEP, heading_angle, heading_number
from ur_nodes.navigation.planning.outline_motions import (
    MotionPose,
    MotionPrimitive,
    Steering,
    course_of,
    gears_by_turn,
    list_pieces,
)

_STEP = 0.05  # m between poses

Place = tuple[float, float, float]


def list_shots(start: Place, goal: Place, radius: float, longest: float) -> list[list[Place]]:
    """The ways ahead from a pose (m, m, rad) to another that are at most `longest` m, the shortest first, as poses."""
    paths = sorted(path for path in _paths(start, goal, radius) if path[0] <= longest)
    return [_poses_along(start, goal, pieces, radius) for _, pieces in paths]


def _paths(start: Place, goal: Place, radius: float) -> Iterator[tuple[float, tuple[tuple[int, float], ...]]]:
    """Lengths (m) and pieces: the side to which each bends (1 left, -1 right, 0 straight), and its length in radii."""
    dx, dy = goal[0] - start[0], goal[1] - start[1]
    bearing, far = math.atan2(dy, dx), math.hypot(dx, dy) / radius
    here, there = start[2] - bearing, goal[2] - bearing
    for side in (1, -1):
        a, b = side * here, side * there  # a way that begins to the right is the mirror image of one to the left
        x, y = far + math.sin(a) - math.sin(b), math.cos(b) - math.cos(a)
        course = math.atan2(y, x)
        yield _way(side, side, (course - a) % math.tau, math.hypot(x, y), (b - course) % math.tau, radius)
        x, y = far + math.sin(a) + math.sin(b), -math.cos(a) - math.cos(b)
        if (square := x * x + y * y - 4.0) >= 0.0:
            line = math.sqrt(square)
            course = math.atan2(y, x) + math.atan2(2.0, line)
            yield _way(side, -side, (course - a) % math.tau, line, (course - b) % math.tau, radius)


def _way(
    first: int, last: int, begin: float, line: float, end: float, radius: float
) -> tuple[float, tuple[tuple[int, float], ...]]:
    return radius * (begin + line + end), ((first, begin), (0, line), (last, end))


def _poses_along(start: Place, goal: Place, pieces: tuple[tuple[int, float], ...], radius: float) -> list[Place]:
    x, y, yaw = start
    poses = []
    for side, length in pieces:
        count = math.ceil(length * radius / _STEP)
        for step in range(1, count + 1):
            along = length * step / count
            turned = side * along
            chord = radius * along if side == 0 else 2.0 * radius * math.sin(along / 2.0)
            middle = yaw + turned / 2.0
            poses.append((x + chord * math.cos(middle), y + chord * math.sin(middle), yaw + turned))
        if count:
            x, y, yaw = poses[-1]
    return [*poses[:-1], goal] if poses else []


@dataclass(frozen=True, slots=True)
class SearchCosts:
    """Costs: of a metre not driven ahead, a change of gear (m), a metre with no room beside it.

    `greed` is the weight of what is left of the way.
    """

    backward: float
    reversal: float
    narrow: float
    greed: float


SPINNING = SearchCosts(2.0, 0.5, 3.0, 1.3)
SHUNTING = SearchCosts(1.3, 0.2, 2.0, 2.5)  # without turns on the spot: the way is longer than the crow flies


Floats = NDArray[np.float64]

_SPIN_COST = 0.4  # m a rad
_BEGIN_SPIN = 0.25  # m: of a turn on the spot that begins
_DIRECT = 2.5  # m: from the goal, where straight lines to it are tried
_RUN_UPS = (0.3, 0.45, 0.6, 0.75, 0.9, 1.1, -0.3, -0.45, -0.6, -0.75, -0.9)  # m: of the last of two such lines
_SHORT = 0.4  # m: of a line that may be driven back
_SHOT, _SHOT_LONGER = 4.0, 1.5  # m: from the goal, where arcs and lines to it are tried; and how long they may be
_SHOT_EVERY = 8  # states
_BACK = tuple(1.0 - 0.05 * step for step in range(1, 21))  # shares of that line
_SHUNTS = (0.0, 0.5, 1.0)  # m: of a straight line after such a way, driven in the other gear


@dataclass(frozen=True, slots=True, eq=False)
class SearchGrid:
    """A part of a map for one search. `blocked`, `narrow` (height, width) are headings as bits.

    At those the outline touches something, or would with some room beside it. `weights` (height, width) are the costs
    of a metre, inf where the robot's middle must not be; `ahead` (height, width) what is left to the goal, m.
    """

    blocked: NDArray[np.uint64]
    narrow: NDArray[np.uint64]
    weights: Floats
    ahead: Floats
    resolution: float


class SearchEnd(NamedTuple):
    """The result: `motions`, empty when none was found; `whole`: everything in reach was searched."""

    motions: tuple[MotionPose, ...]
    whole: bool
    expanded: int


def find_motions(
    grid: SearchGrid,
    start: tuple[float, float, float],
    goal: tuple[float, float, float | None],
    steering: Steering,
    *,
    most: int = 60_000,
) -> SearchEnd:
    """Search from pose to pose, in m from the grid's corner and rad along its axes; at most `most` states go on.

    A goal without a heading is reached with any. The start is taken as free. Deterministic.
    """
    return _Search(grid, goal, steering).run(start, most)


class _Node(NamedTuple):
    x: float
    y: float
    heading: int
    gear: int
    cost: float
    before: int  # number of the node before, -1 at the start
    piece: MotionPrimitive | None


class _Search:
    def __init__(self, grid: SearchGrid, goal: tuple[float, float, float | None], steering: Steering) -> None:
        self._height, self._width = (int(length) for length in grid.blocked.shape)
        self._scale = 1.0 / grid.resolution
        self._blocked: list[int] = grid.blocked.reshape(-1).tolist()
        self._narrow: list[int] = grid.narrow.reshape(-1).tolist()
        self._weights: list[float] = grid.weights.reshape(-1).tolist()
        self._ahead: list[float] = grid.ahead.reshape(-1).tolist()
        self._goal, self._yaw = goal[:2], goal[2]
        self._heading = None if goal[2] is None else heading_number(goal[2])
        self._steering = steering
        self._costs = SPINNING if steering.spins else SHUNTING
        self._near = (1.5 if steering.spins else 1.0) * grid.resolution
        self._nodes: list[_Node] = []

    def run(self, start: tuple[float, float, float], most: int) -> SearchEnd:
        pieces = list_pieces(self._steering)
        heading = heading_number(start[2])
        cell = self._cell(start[0], start[1])
        if cell < 0 or not math.isfinite(self._ahead[cell]):
            return SearchEnd((), whole=True, expanded=0)
        nodes = self._nodes
        nodes.append(_Node(start[0], start[1], heading, 0, 0.0, -1, None))
        queue = [(self._costs.greed * self._left(cell, heading), 0)]
        best: dict[int, float] = {cell * HEADINGS + heading: 0.0}
        closed: set[int] = set()
        expanded = 0
        while queue and expanded < most:
            _, number = heapq.heappop(queue)
            node = nodes[number]
            cell = self._cell(node.x, node.y)
            key = cell * HEADINGS + node.heading
            if key in closed:
                continue
            closed.add(key)
            expanded += 1
            end = self._arrive(node, number)
            if end:
                return SearchEnd(end, whole=False, expanded=expanded)
            for piece in pieces[node.heading]:
                cost = self._cost(node, piece)
                if cost == math.inf:
                    continue
                x, y = node.x + piece.dx, node.y + piece.dy
                cell = self._cell(x, y)
                key = cell * HEADINGS + piece.heading
                total = node.cost + cost
                if key in closed or total >= best.get(key, math.inf):
                    continue
                best[key] = total
                gear = piece.gear or node.gear
                nodes.append(_Node(x, y, piece.heading, gear, total, number, piece))
                heapq.heappush(queue, (total + self._costs.greed * self._left(cell, piece.heading), len(nodes) - 1))
        return SearchEnd((), whole=not queue, expanded=expanded)

    def _left(self, cell: int, heading: int) -> float:
        """The least way that is left, m: a robot that cannot turn on the spot drives arcs to another heading."""
        if self._heading is None or self._steering.spins:
            return self._ahead[cell]
        turned = abs((heading - self._heading + HEADINGS // 2) % HEADINGS - HEADINGS // 2) * STEP
        return max(self._ahead[cell], turned * self._steering.radius)

    def _cell(self, x: float, y: float) -> int:
        row, column = int(y * self._scale), int(x * self._scale)
        if x < 0.0 or y < 0.0 or row >= self._height or column >= self._width:
            return -1
        return row * self._width + column

    def _cost(self, node: _Node, piece: MotionPrimitive) -> float:
        """The cost of a primitive, inf where it touches something."""
        narrow, weight = False, 0.0
        for dx, dy, heading in piece.checks:
            cell = self._cell(node.x + dx, node.y + dy)
            if cell < 0 or self._blocked[cell] >> heading & 1:
                return math.inf
            weight = max(weight, self._weights[cell])
            narrow = narrow or bool(self._narrow[cell] >> heading & 1)
        if piece.gear == 0:
            again = node.piece is not None and node.piece.gear == 0
            if again and node.piece is not None and node.piece.turned * piece.turned < 0:
                return math.inf
            spin = _SPIN_COST * STEP * abs(piece.turned) * (self._costs.narrow if narrow else 1.0)
            return spin if again else spin + _BEGIN_SPIN
        cost = piece.length * weight * (self._costs.narrow if narrow else 1.0)
        if piece.gear != 1:
            cost *= self._costs.backward
        if node.gear and node.gear != piece.gear:
            cost += self._costs.reversal
        return cost + 0.1 * piece.length * abs(piece.turned)

    def _arrive(self, node: _Node, number: int) -> tuple[MotionPose, ...]:
        """The whole motion, if the goal is here or straight lines lead there; else nothing."""
        away = math.dist((node.x, node.y), self._goal)
        if away < self._near and self._heading in (None, node.heading):
            return self._trace(number)
        if not self._steering.spins:
            return self._shoot(node, number, away)
        if away > _DIRECT:
            return ()
        here = MotionPose(node.x, node.y, heading_angle(node.heading), node.gear)
        for corner in self._corners():
            tail = self._go(here, corner)
            if tail is not None and corner != self._goal:
                rest = self._go(tail[-1] if tail else here, self._goal)
                tail = None if rest is None else tail + rest
            if tail is None:
                continue
            last = tail[-1] if tail else here
            spin = [] if self._heading is None else self._spin(*self._goal, heading_number(last.yaw), self._heading)
            if spin is not None:
                return self._trace(number) + tuple(tail + spin)
        return ()

    def _shoot(self, node: _Node, number: int, away: float) -> tuple[MotionPose, ...]:
        """The whole motion, if arcs and a line lead to the goal from here, ahead or back."""
        if self._yaw is None or away > _SHOT or number % _SHOT_EVERY:
            return ()
        radius, longest = self._steering.radius, _SHOT_LONGER * (away + self._steering.radius)
        (x, y), yaw = self._goal, self._yaw
        for shunt in _SHUNTS:
            for gear in (1, -1):
                half = 0.0 if gear > 0 else math.pi
                here = node.x, node.y, heading_angle(node.heading) + half
                far = gear * shunt
                there = x + far * math.cos(yaw), y + far * math.sin(yaw), yaw + half
                last = [MotionPose(x + s * far * math.cos(yaw), y + s * far * math.sin(yaw), yaw, -gear) for s in _BACK]
                last = last if shunt else []
                for poses in list_shots(here, there, radius, longest):
                    motions = [*(MotionPose(px, py, angle - half, gear) for px, py, angle in poses), *last]
                    if all(self._is_free(motion) for motion in motions):
                        return self._trace(number) + tuple(motions)
        return ()

    def _is_free(self, pose: MotionPose) -> bool:
        cell = self._cell(pose.x, pose.y)
        return (
            cell >= 0 and not self._blocked[cell] >> heading_number(pose.yaw) & 1 and math.isfinite(self._weights[cell])
        )

    def _corners(self) -> list[tuple[float, float]]:
        """Places where a straight line to the goal may begin: at it, or before or behind it along its heading."""
        if self._heading is None:
            return [self._goal]
        c, s = math.cos(self._heading * STEP), math.sin(self._heading * STEP)
        return [self._goal, *((self._goal[0] - d * c, self._goal[1] - d * s) for d in _RUN_UPS)]

    def _go(self, here: MotionPose, point: tuple[float, float]) -> list[MotionPose] | None:
        """Turn on the spot and go straight to a place, ahead, or in another gear where it is near."""
        away = math.dist(here[:2], point)
        if away < 0.02:
            return []
        bearing = math.atan2(point[1] - here.y, point[0] - here.x)
        gears: tuple[int, ...] = (1, -1) if away <= _SHORT else (1,)
        if self._steering.sideways and away <= _SHORT:
            gears = gears_by_turn(here.yaw, bearing)
        for gear in gears:
            yaw = bearing - course_of(gear)
            line = self._line(here, bearing, away, heading_number(yaw))
            spin = None if line is None else self._spin(here.x, here.y, heading_number(here.yaw), heading_number(yaw))
            if line is not None and spin is not None:
                return spin + [MotionPose(x, y, yaw, gear) for x, y in line]
        return None

    def _line(self, here: MotionPose, bearing: float, away: float, heading: int) -> list[tuple[float, float]] | None:
        count = max(1, math.ceil(away * self._scale))
        points = []
        for step in range(count + 1):
            share = away * step / count
            x, y = here.x + share * math.cos(bearing), here.y + share * math.sin(bearing)
            cell = self._cell(x, y)
            if cell < 0 or self._blocked[cell] >> heading & 1 or self._weights[cell] == math.inf:
                return None
            points.append((x, y))
        return points[1:]

    def _spin(self, x: float, y: float, heading: int, wanted: int) -> list[MotionPose] | None:
        """Turn on the spot, the shorter way round that is free."""
        cell = self._cell(x, y)
        if cell < 0:
            return None
        left = (wanted - heading) % HEADINGS
        paths = (1, left), (-1, HEADINGS - left)
        for sign, count in sorted(paths, key=lambda path: path[1]):
            numbers = [(heading + sign * step) % HEADINGS for step in range(1, count % HEADINGS + 1)]
            if all(not self._blocked[cell] >> number & 1 for number in numbers):
                return [MotionPose(x, y, heading_angle(number), 0) for number in numbers]
        return None

    def _trace(self, number: int) -> tuple[MotionPose, ...]:
        motions: list[MotionPose] = []
        while number >= 0:
            node = self._nodes[number]
            if node.piece is None:
                motions.append(MotionPose(node.x, node.y, heading_angle(node.heading), 0))
            else:
                begin = self._nodes[node.before]
                for dx, dy, heading in reversed(node.piece.checks):
                    motions.append(MotionPose(begin.x + dx, begin.y + dy, heading_angle(heading), node.piece.gear))
            number = node.before
        return tuple(reversed(motions))
