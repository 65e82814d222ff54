"""Arc, line and arc from pose to pose, for a robot that cannot turn on the spot (Dubins, 1957)."""

from __future__ import annotations

import math
from collections.abc import Iterator

_STEP = 0.05  # m between poses

Place = tuple[float, float, float]


def list_shots(start: Place, goal: Place, radius: float, longest: float) -> list[list[Place]]:
    """The ways ahead from a pose (m, m, rad) to another that are at most `longest` m, the shortest first, as poses."""
    ways = sorted(way for way in _ways(start, goal, radius) if way[0] <= longest)
    return [_poses_along(start, goal, pieces, radius) for _, pieces in ways]


def _ways(start: Place, goal: Place, radius: float) -> Iterator[tuple[float, tuple[tuple[int, float], ...]]]:
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
