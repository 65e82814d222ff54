"""Drive wheels and casters of a description."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product

from ur.robot.description.outlines import list_corners
from ur.robot.description.pose import Pose, Vector
from ur.robot.description.urdf_parts import Description, Joint, Link, Shape

_UPRIGHT = 0.9  # the vertical component of a unit axis above which the axis is a swivel's
_SAME_AXLE = 0.02  # m
_SAME_RADIUS = 0.8
_LEVEL = 0.02  # m above the axles at which a support may lie
_ROUND = 0.8  # the least ratio of a round mesh's two lengths across the axis
_CASTER = re.compile(r"caster|castor|ball|swivel|omni|support", re.IGNORECASE)
_WHEEL = re.compile(r"wheel|tyre|(^|_)tire", re.IGNORECASE)
_GROUND_ROOTS = ("base_footprint", "base_footprint_link")


@dataclass(frozen=True, slots=True)
class Wheel:
    """A wheel that turns about a horizontal axle: its link, its centre in the root link, and its size if known."""

    joint: Joint
    x: float
    y: float
    z: float
    radius: float | None
    width: float | None
    mass: float
    source: str  # of the radius


Sides = tuple[tuple[Wheel, ...], tuple[Wheel, ...]]  # left, right


@dataclass(frozen=True, slots=True)
class FreeSupport:
    """A passive support: its contact point with the ground, in the root link, and its radius if known."""

    link: str
    x: float
    y: float
    radius: float | None


@dataclass(frozen=True, slots=True)
class DriveGeometry:
    """The driven wheels, as many left as right, and the passive supports."""

    left: tuple[Wheel, ...] = ()
    right: tuple[Wheel, ...] = ()
    casters: tuple[FreeSupport, ...] = ()

    @property
    def wheels(self) -> tuple[Wheel, ...]:
        """The wheels of both sides."""
        return self.left + self.right


def find_drive(description: Description) -> DriveGeometry:
    """Find the driven wheels: those that a Gazebo plugin names, else the largest pairs of wheels on one axle.

    The result has no wheels if none were found.
    """
    places = description.poses()
    links = {link.name: link for link in description.links}
    wheels = [
        _wheel(description, joint, links[joint.child], places[joint.child])
        for joint in description.joints
        if joint.kind == "continuous" and not _is_upright(joint, places)
    ]
    sides = _find_sides(description, places, wheels)
    chosen = {wheel.joint.child for side in sides for wheel in side}
    axle = max((wheel.z for side in sides for wheel in side), default=math.inf) + _LEVEL
    others = [
        FreeSupport(w.joint.child, w.x, w.y, w.radius)
        for w in wheels
        if w.joint.child not in chosen and w.z - (w.radius or 0.0) <= axle  # else it is a joint of an arm
    ]
    known = {contact.link for contact in others}
    children = description.children()
    for name, link in links.items():
        solid = link.collision or link.visual or link.meshes
        alone = name not in known and name not in chosen
        if not solid or not alone or not _CASTER.search(name) or _has_wheel_below(children, name, known):
            continue
        pose = places[name]
        shapes = (*link.collision, *link.visual)
        if min((z for shape in shapes for _, _, z in list_corners(shape, pose)), default=pose.at[2]) <= axle:
            others.append(FreeSupport(name, places[name].at[0], places[name].at[1], _size(link)[0]))
    return DriveGeometry(sides[0], sides[1], tuple(others))


def _find_sides(description: Description, poses: Mapping[str, Pose], wheels: list[Wheel]) -> Sides:
    """Find the driven wheels by the strongest evidence: a plugin, continuous joints, their names, or swivel joints."""
    plugin = description.drive
    named = {*plugin.left, *plugin.right} if plugin else set()
    sides = _sides([wheel for wheel in wheels if wheel.joint.name in named])
    if sides[0] and sides[1]:
        return sides
    swivels = _swivels(description, poses)
    own = [wheel for wheel in wheels if not _names_caster(wheel.joint)]
    # Find the wheels of a description without movable joints: links with the name and the shape of a wheel
    links = {link.name: link for link in description.links}
    found = []
    for joint in description.joints:
        place = poses[joint.child]
        if joint.kind == "fixed" and _WHEEL.search(joint.child) and not _names_caster(joint):
            sideways = replace(joint, axis=place.rotation[1])  # the y axis of the root in the link's frame
            found.append(_wheel(description, sideways, links[joint.child], place))
    for candidates in (
        [wheel for wheel in own if wheel.joint.child not in swivels],
        [wheel for wheel in found if wheel.radius],
        [wheel for wheel in own if wheel.joint.child in swivels],
    ):
        sides = _largest_pairs(_sides(candidates))
        if sides[0]:
            return sides
    return (), ()


def _sides(wheels: list[Wheel]) -> Sides:
    middle = (max(wheel.y for wheel in wheels) + min(wheel.y for wheel in wheels)) / 2.0 if wheels else 0.0
    left = tuple(wheel for wheel in wheels if wheel.y > middle + 0.005)
    right = tuple(wheel for wheel in wheels if wheel.y < middle - 0.005)
    return left, right


def _largest_pairs(sides: Sides) -> Sides:
    pairs = [
        (left, right)
        for left, right in product(*sides)
        if abs(left.x - right.x) < _SAME_AXLE and abs(left.z - right.z) < _SAME_AXLE
    ]
    largest = max((left.radius or 0.0 for left, _ in pairs), default=0.0)
    pairs = [pair for pair in pairs if (pair[0].radius or 0.0) >= _SAME_RADIUS * largest]
    return tuple(dict.fromkeys(left for left, _ in pairs)), tuple(dict.fromkeys(right for _, right in pairs))


def _wheel(description: Description, joint: Joint, link: Link, pose: Pose) -> Wheel:
    radius, width, middle = _measure(link, joint.axis)
    source = f"{'mesh' if radius and not _has_round_shape(link) else 'shape'} of link {link.name}"
    plugin = description.drive
    if radius is None and plugin and plugin.radius and joint.name in (*plugin.left, *plugin.right):
        radius, source = plugin.radius, "gazebo plugin"
    if radius is None and description.root in _GROUND_ROOTS and pose.at[2] > 0.005:
        radius, source = pose.at[2], f"height of joint {joint.name} above {description.root}"
    if radius is None and (solid := _solid_wheel(link)):
        (radius, width), source = solid, f"inertia of link {link.name}"
    mass = link.inertia.mass if link.inertia else 0.0
    if joint.kind != "fixed":  # it turns about the joint, independent of the position of its shape
        along = _along(middle, joint.axis)
        middle = (along * joint.axis[0], along * joint.axis[1], along * joint.axis[2])
    return Wheel(joint, *pose.apply(middle), radius, width, mass, source)


def _has_round_shape(link: Link) -> bool:
    return any(shape.kind in ("cylinder", "sphere") for shape in (*link.collision, *link.visual))


def _measure(link: Link, axis: Vector) -> tuple[float | None, float | None, Vector]:
    """Return radius, width and centre of the link's largest shape that is round about an axis."""
    found: list[tuple[float, float | None, Vector]] = []
    for shapes in (link.collision, link.visual):
        for shape in shapes:
            if shape.kind in ("cylinder", "sphere"):
                found.append((shape.size[0], shape.size[1] if shape.kind == "cylinder" else None, shape.pose.at))
            elif shape.kind == "mesh" and (turned := _measure_mesh(shape, axis)):
                found.append(turned)
        if found:
            return max(found, key=lambda each: each[0])
    return None, None, (0.0, 0.0, 0.0)


def _measure_mesh(shape: Shape, axis: Vector) -> tuple[float, float, Vector] | None:
    """Measure a mesh, as `_measure` does; None if its two lengths across the axis differ much."""
    points = [shape.pose.apply(point) for point in shape.points]
    least = min(range(3), key=lambda n: abs(axis[n]))
    across = _across(axis, (float(least == 0), float(least == 1), float(least == 2)))
    frame = (axis, across, _across(axis, across))
    ends = [(min(values), max(values)) for side in frame for values in [[_along(point, side) for point in points]]]
    (width, *others) = (high - low for low, high in ends)
    if min(others) < _ROUND * max(others) or max(others) <= 0.0:
        return None
    middles = [(low + high) / 2.0 for low, high in ends]
    x, y, z = (sum(middle * side[n] for middle, side in zip(middles, frame, strict=True)) for n in range(3))
    return max(others) / 2.0, width, (x, y, z)


def _along(point: Vector, axis: Vector) -> float:
    return sum(a * b for a, b in zip(point, axis, strict=True))


def _across(a: Vector, b: Vector) -> Vector:
    """Return the direction that is perpendicular to two others."""
    x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    length = math.hypot(x, y, z)
    return x / length, y / length, z / length


def _size(link: Link) -> tuple[float | None, float | None]:
    """Return radius and width of the largest round shape of a link; None where it has none."""
    for shapes in (link.collision, link.visual):
        round_ = [shape for shape in shapes if shape.kind in ("cylinder", "sphere")]
        if round_:
            largest = max(round_, key=lambda shape: shape.size[0])
            return largest.size[0], largest.size[1] if largest.kind == "cylinder" else None
    return None, None


def _solid_wheel(link: Link) -> tuple[float, float] | None:
    """Return radius and width of a solid wheel with the inertia of a link: m r^2 / 2 and m (3 r^2 + w^2) / 12."""
    if link.inertia is None or link.inertia.mass <= 0.0:
        return None
    # The moment about the axle is the one that differs from the other two.
    low, middle, high = sorted(link.inertia.moments)
    axial, radial = (high, (low + middle) / 2.0) if high - middle >= middle - low else (low, (middle + high) / 2.0)
    radius = math.sqrt(max(0.0, 2.0 * axial / link.inertia.mass))
    width = math.sqrt(max(0.0, 12.0 * radial / link.inertia.mass - 3.0 * radius**2))
    return (radius, width) if 0.01 < radius < 1.0 and 0.002 < width < 2.0 * radius else None


def _is_upright(joint: Joint, poses: Mapping[str, Pose]) -> bool:
    return abs(poses[joint.child].turn(joint.axis)[2]) > _UPRIGHT


def _names_caster(joint: Joint) -> bool:
    return bool(_CASTER.search(joint.name) or _CASTER.search(joint.child))


def _swivels(description: Description, poses: Mapping[str, Pose]) -> set[str]:
    """Return the links of swivel casters: those that turn about a vertical axis, and the links below them."""
    children = description.children()
    turning = [joint for joint in description.joints if joint.kind in ("continuous", "revolute")]
    left = [joint.child for joint in turning if _is_upright(joint, poses)]
    found: set[str] = set()
    while left:
        name = left.pop()
        if name not in found:
            found.add(name)
            left += children.get(name, ())
    return found


def find_steering(description: Description, drive: DriveGeometry) -> tuple[str, ...]:
    """Find the steering joints of wheels, as cars have them: vertical, with a limited range, and not of casters."""
    places = description.poses()
    wheels = {wheel.joint.child for wheel in drive.wheels} | {contact.link for contact in drive.casters}
    children = description.children()
    return tuple(
        joint.name
        for joint in description.joints
        if joint.kind == "revolute"
        and _is_upright(joint, places)
        and not _names_caster(joint)
        and wheels.intersection(children.get(joint.child, ()))
    )


def _has_wheel_below(children: Mapping[str, list[str]], name: str, wheels: set[str]) -> bool:
    """Return whether a link has a wheel below it, as the fork of a caster does."""
    left = [name]
    while left:
        for child in children.get(left.pop(), ()):
            if child in wheels or _CASTER.search(child):
                return True
            left.append(child)
    return False
