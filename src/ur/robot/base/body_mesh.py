"""Triangle mesh of a base's body: the hull of its outline, extruded upwards, with wells for the wheels."""

import struct
from collections.abc import Iterable, Sequence
from itertools import pairwise

from ur.robot.base import Base
from ur.robot.base.outline import Point, find_hull

Vertex = tuple[float, float, float]
Triangle = tuple[Vertex, Vertex, Vertex]

_GAP = 0.005  # between a wheel and its well, m
_THINNEST_DECK = 0.01
_THINNEST_SKIRT = 0.02  # outside a wheel


def make_body(base: Base) -> list[Triangle]:
    """Return the triangles of the body in `base_footprint`, m, each counter-clockwise seen from outside.

    Above the wheels, the body has the whole outline where its height allows it; below, the space of the wheels is left
    out.
    """
    outline = find_hull(base.body or base.footprint)
    wheels = base.wheels
    bottom = min(max(base.ground_clearance, 2.0 * wheels.radius + _GAP), base.height - _THINNEST_DECK)
    inner = wheels.separation / 2.0 - wheels.width / 2.0 - _GAP
    outer = wheels.separation / 2.0 + wheels.width / 2.0 + _GAP
    reach = wheels.radius + _GAP
    beside = _keep(_keep(outline, (1.0, 0.0), reach), (-1.0, 0.0), reach)
    triangles = list(_prism(outline, bottom, base.height))
    parts = [
        _keep(_keep(beside, (0.0, 1.0), inner), (0.0, -1.0), inner),
        _keep(outline, (-1.0, 0.0), -reach),
        _keep(outline, (1.0, 0.0), -reach),
    ]
    if min(max(y for _, y in outline), -min(y for _, y in outline)) > outer + _THINNEST_SKIRT:
        parts += [_keep(beside, (0.0, -1.0), -outer), _keep(beside, (0.0, 1.0), -outer)]
    for part in parts:
        if len(part) > 2 and bottom > base.ground_clearance:
            triangles += _prism(part, base.ground_clearance, bottom)
    return triangles


def write_stl(triangles: Sequence[Triangle]) -> bytes:
    """Return the triangles as a binary STL file, in m."""
    parts = [b"body of a robot base, in m".ljust(80, b"\0"), struct.pack("<I", len(triangles))]
    for triangle in triangles:
        numbers = [number for vertex in (_normal(triangle), *triangle) for number in vertex]
        parts.append(struct.pack("<12fH", *numbers, 0))
    return b"".join(parts)


def _keep(polygon: Sequence[Point], normal: Point, limit: float) -> list[Point]:
    """Clip a convex polygon to the half-plane `normal . point <= limit` (Sutherland and Hodgman)."""
    kept: list[Point] = []
    for (ax, ay), (bx, by) in pairwise([*polygon, *polygon[:1]]):
        a, b = (normal[0] * x + normal[1] * y - limit for x, y in ((ax, ay), (bx, by)))
        if a <= 0.0:
            kept.append((ax, ay))
        if (a < 0.0 < b) or (b < 0.0 < a):
            share = a / (a - b)
            kept.append((ax + share * (bx - ax), ay + share * (by - ay)))
    return kept


def _prism(polygon: Sequence[Point], bottom: float, top: float) -> Iterable[Triangle]:
    low = [(x, y, bottom) for x, y in polygon]
    high = [(x, y, top) for x, y in polygon]
    for n in range(1, len(polygon) - 1):
        yield high[0], high[n], high[n + 1]
        yield low[0], low[n + 1], low[n]
    for n in range(len(polygon)):
        after = (n + 1) % len(polygon)
        yield low[n], low[after], high[after]
        yield low[n], high[after], high[n]


def _normal(triangle: Triangle) -> Vertex:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = triangle
    ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = (x * x + y * y + z * z) ** 0.5 or 1.0
    return x / length, y / length, z / length
