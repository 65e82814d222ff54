"""Dimensions of a description: its outline on the ground, its height, and its ground clearance."""

import math
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise, product

from ur.robot.base.outline import Point, find_hull
from ur.robot.description.pose import Pose, Vector
from ur.robot.description.urdf_parts import Description, Link, Shape

_SIDES = 16  # of the polygon round a circle
_MOST_POINTS = 24
_FINEST = 1000.0  # points are rounded to 1 / this, in m


@dataclass(frozen=True, slots=True)
class Extent:
    """The space of a set of links, as points in the root link.

    `estimated` are links whose size is estimated from their inertia.
    """

    points: tuple[Vector, ...]
    estimated: tuple[str, ...]
    unknown: tuple[str, ...]  # links that have only meshes


def measure_extent(description: Description, leave_out: Collection[str], *, careful: bool = False) -> Extent:
    """Return the corners of all fixed links except `leave_out`: of collision and of visual geometries.

    A link with meshes of unknown size is replaced by the box that has its inertia. A `careful` measurement uses no such
    box, and visual geometries only of links without collision geometry.
    """
    places = description.poses()
    children: dict[str, list[str]] = {}
    for joint in description.joints:
        if joint.kind == "fixed":
            children.setdefault(joint.parent, []).append(joint.child)
    found, left = {description.root}, [description.root]
    while left:
        below = children.get(left.pop(), [])
        found.update(below)
        left += below
    rigid = found
    points: list[Vector] = []
    estimated: list[str] = []
    unknown: list[str] = []
    for link in description.links:
        if link.name not in rigid or link.name in leave_out:
            continue
        shapes = (link.collision or link.visual) if careful else (*link.collision, *link.visual)
        if not shapes and link.meshes:
            solid = None if careful else _solid_box(link)
            shapes = (solid,) if solid else ()
            (estimated if solid else unknown).append(link.name)
        for shape in shapes:
            points += list_corners(shape, places[link.name])
    return Extent(tuple(points), tuple(estimated), tuple(unknown))


def draw_outline(points: Iterable[Point]) -> tuple[Point, ...]:
    """Return the hull of points, counter-clockwise, rounded outwards to mm; () if it has no area.

    A hull of many points becomes a polygon whose edges have 24 fixed directions.
    """
    hull = find_hull((x, y) for x, y in points)
    if len(hull) > _MOST_POINTS:
        turns = [2.0 * math.pi * n / _MOST_POINTS for n in range(_MOST_POINTS)]
        lines = [(math.cos(turn), math.sin(turn)) for turn in turns]
        reach = [max(x * nx + y * ny for x, y in hull) for nx, ny in lines]
        sides = list(zip(lines, reach, strict=True))
        step = math.sin(2.0 * math.pi / _MOST_POINTS)  # the determinant of two neighbours
        hull = [
            ((a * by - b * ay) / step, (b * ax - a * bx) / step)
            for ((ax, ay), a), ((bx, by), b) in pairwise([*sides, sides[0]])
        ]
    if len(hull) < 3:
        return ()
    x0, y0 = sum(x for x, _ in hull) / len(hull), sum(y for _, y in hull) / len(hull)
    rounded = find_hull((_away(x, x0), _away(y, y0)) for x, y in hull)
    return tuple(rounded) if len(rounded) > 2 else ()


def _away(value: float, middle: float) -> float:
    scaled = round(value * _FINEST, 3)
    return (math.ceil(scaled) if value >= middle else math.floor(scaled)) / _FINEST + 0.0


def list_corners(shape: Shape, pose: Pose) -> Iterator[Vector]:
    """Yield the outermost points of a shape of a link at `pose`."""
    inside = pose.then(shape.pose)
    if shape.kind == "box":
        x, y, z = (length / 2.0 for length in shape.size)
        yield from (inside.apply((a * x, b * y, c * z)) for a, b, c in product((-1.0, 1.0), repeat=3))
        return
    if shape.kind == "mesh":
        yield from (inside.apply(point) for point in shape.points)
        return
    radius = shape.size[0] / math.cos(math.pi / _SIDES)
    circle = [
        (radius * math.cos(turn), radius * math.sin(turn))
        for turn in (2.0 * math.pi * n / _SIDES for n in range(_SIDES))
    ]
    if shape.kind == "cylinder":
        half = shape.size[1] / 2.0
        yield from (inside.apply((x, y, z)) for x, y in circle for z in (-half, half))
        return
    cx, cy, cz = inside.at
    yield from ((cx + x, cy + y, cz) for x, y in circle)
    yield from ((cx, cy, cz + z) for z in (-shape.size[0], shape.size[0]))


def _solid_box(link: Link) -> Shape | None:
    """Return the solid box with the inertia of a link: x^2 = 6 (iyy + izz - ixx) / m, and so on."""
    if link.inertia is None or link.inertia.mass <= 0.0:
        return None
    total = sum(link.inertia.moments)
    sides = tuple(math.sqrt(max(0.0, 6.0 * (total - 2.0 * own) / link.inertia.mass)) for own in link.inertia.moments)
    if not all(0.02 < side < 5.0 for side in sides):
        return None
    return Shape("box", sides, link.inertia.pose)
