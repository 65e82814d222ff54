"""Outlines: polygons of (x, y) points, in order."""

import math
from collections.abc import Iterable, Sequence

Point = tuple[float, float]


def measure_area(points: Sequence[Point]) -> float:
    """Return the area of a simple polygon in m^2, by the shoelace formula; negative for clockwise points."""
    ends = [*points[1:], points[0]]
    return sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(points, ends, strict=True)) / 2.0


def find_centroid(points: Sequence[Point]) -> Point:
    """Return the centroid of a simple polygon, by the shoelace formula."""
    ends = [*points[1:], points[0]]
    edges = [(x0 + x1, y0 + y1, x0 * y1 - x1 * y0) for (x0, y0), (x1, y1) in zip(points, ends, strict=True)]
    total = 3.0 * sum(cross for _, _, cross in edges)
    return sum(x * cross for x, _, cross in edges) / total, sum(y * cross for _, y, cross in edges) / total


def find_crossing(points: Sequence[Point]) -> tuple[int, int] | None:
    """Return the numbers (from 1) of two points whose edges cross, or None for a simple polygon."""
    count = len(points)
    for first in range(count):
        for second in range(first + 2, count):
            a, b = points[first], points[first + 1]
            c, d = points[second], points[(second + 1) % count]
            if (second + 1) % count != first and _side(a, b, c) * _side(a, b, d) < 0 > _side(c, d, a) * _side(c, d, b):
                return first + 1, second + 1
    return None


def find_hull(points: Iterable[Point]) -> list[Point]:
    """Return the convex hull, counter-clockwise (Andrew's monotone chain)."""
    ordered = sorted(set(points))
    return _half_hull(ordered)[:-1] + _half_hull(ordered[::-1])[:-1]


def _half_hull(points: Sequence[Point]) -> list[Point]:
    hull: list[Point] = []
    for x, y in points:
        while len(hull) > 1:
            (ax, ay), (bx, by) = hull[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                break
            hull.pop()
        hull.append((x, y))
    return hull


def is_inside(point: Point, points: Sequence[Point], tolerance: float) -> bool:
    """Return whether a point lies in the convex hull of others, or at most `tolerance` (m) outside it."""
    hull = find_hull(points)
    return all(
        _side(a, b, point) >= -tolerance * math.dist(a, b) for a, b in zip(hull, [*hull[1:], hull[0]], strict=True)
    )


def _side(a: Point, b: Point, p: Point) -> float:
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
