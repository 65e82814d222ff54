"""The outline of a base: a polygon of (x, y) points, in order."""

from __future__ import annotations

from collections.abc import Sequence

Point = tuple[float, float]


def measure_area(points: Sequence[Point]) -> float:
    """The area of a simple polygon, m^2; negative when it goes round clockwise (the shoelace formula)."""
    ends = [*points[1:], points[0]]
    return sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(points, ends, strict=True)) / 2.0


def find_crossing(points: Sequence[Point]) -> tuple[int, int] | None:
    """The numbers (from 1) of the points whose edges cross each other, or None for a simple polygon."""
    count = len(points)
    for first in range(count):
        for second in range(first + 2, count):
            a, b = points[first], points[first + 1]
            c, d = points[second], points[(second + 1) % count]
            if (second + 1) % count != first and _side(a, b, c) * _side(a, b, d) < 0 > _side(c, d, a) * _side(c, d, b):
                return first + 1, second + 1
    return None


def _side(a: Point, b: Point, p: Point) -> float:
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
