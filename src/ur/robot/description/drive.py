"""Drive wheels and casters of a description."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

from ur.robot.description.model import Description, Joint, Link
from ur.robot.description.pose import Pose

_UPRIGHT = 0.9  # the vertical part of a unit axis from which it is that of a swivel
_SAME_AXLE = 0.02  # m
_SAME_RADIUS = 0.8
_CASTER = re.compile(r"caster|castor|ball|swivel|omni|support", re.IGNORECASE)
_GROUND_ROOTS = ("base_footprint", "base_footprint_link")


@dataclass(frozen=True, slots=True)
class Wheel:
    """A wheel that turns about a level axle: its link, its middle in the root link, and its size where it is known."""

    joint: Joint
    x: float
    y: float
    z: float
    radius: float | None
    width: float | None
    mass: float
    source: str  # of the radius


@dataclass(frozen=True, slots=True)
class Contact:
    """A free support: where it touches the ground, in the root link, and its radius where it is known."""

    link: str
    x: float
    y: float
    radius: float | None


@dataclass(frozen=True, slots=True)
class Drive:
    """The wheels that drive, as many left as right, and the free supports."""

    left: tuple[Wheel, ...] = ()
    right: tuple[Wheel, ...] = ()
    casters: tuple[Contact, ...] = ()

    @property
    def wheels(self) -> tuple[Wheel, ...]:
        """Those of both sides."""
        return self.left + self.right


def find_drive(description: Description) -> Drive:
    """The driven wheels: those that a gazebo plugin names, else the largest pairs of wheels on one axle.

    A drive without wheels means that none were found.
    """
    places = description.places()
    links = {link.name: link for link in description.links}
    swivels = _swivels(description, places)
    wheels = [
        _wheel(description, joint, links[joint.child], places[joint.child])
        for joint in description.joints
        if joint.kind == "continuous" and not _is_upright(joint, places)
    ]
    plugin = description.drive
    named = {*plugin.left, *plugin.right} if plugin else set()
    driven = [wheel for wheel in wheels if wheel.joint.name in named]
    sides = _sides(driven)
    if not (sides[0] and sides[1]):
        free = [wheel for wheel in wheels if wheel.joint.child not in swivels and not _names_caster(wheel.joint)]
        sides = _largest_pairs(_sides(free))
    chosen = {wheel.joint.child for side in sides for wheel in side}
    others = [Contact(w.joint.child, w.x, w.y, w.radius) for w in wheels if w.joint.child not in chosen]
    known = {contact.link for contact in others}
    for name, link in links.items():
        solid = link.collision or link.visual or link.meshes
        alone = name not in known | chosen and not _has_wheel_below(description, name, known)
        if _CASTER.search(name) and solid and alone:
            others.append(Contact(name, places[name].at[0], places[name].at[1], _size(link)[0]))
    return Drive(sides[0], sides[1], tuple(others))


def _sides(wheels: list[Wheel]) -> tuple[tuple[Wheel, ...], tuple[Wheel, ...]]:
    middle = (max(wheel.y for wheel in wheels) + min(wheel.y for wheel in wheels)) / 2.0 if wheels else 0.0
    left = tuple(wheel for wheel in wheels if wheel.y > middle + 0.005)
    right = tuple(wheel for wheel in wheels if wheel.y < middle - 0.005)
    return left, right


def _largest_pairs(
    sides: tuple[tuple[Wheel, ...], tuple[Wheel, ...]],
) -> tuple[tuple[Wheel, ...], tuple[Wheel, ...]]:
    pairs = [
        (left, right)
        for left, right in product(*sides)
        if abs(left.x - right.x) < _SAME_AXLE and abs(left.z - right.z) < _SAME_AXLE
    ]
    largest = max((left.radius or 0.0 for left, _ in pairs), default=0.0)
    pairs = [pair for pair in pairs if (pair[0].radius or 0.0) >= _SAME_RADIUS * largest]
    return tuple(dict.fromkeys(left for left, _ in pairs)), tuple(dict.fromkeys(right for _, right in pairs))


def _wheel(description: Description, joint: Joint, link: Link, place: Pose) -> Wheel:
    radius, width = _size(link)
    source = f"shape of link {link.name}"
    plugin = description.drive
    if radius is None and plugin and plugin.radius and joint.name in (*plugin.left, *plugin.right):
        radius, source = plugin.radius, "gazebo plugin"
    if radius is None and description.root in _GROUND_ROOTS and place.at[2] > 0.005:
        radius, source = place.at[2], f"height of joint {joint.name} above {description.root}"
    if radius is None and (solid := _solid_wheel(link)):
        (radius, width), source = solid, f"inertia of link {link.name}"
    mass = link.inertia.mass if link.inertia else 0.0
    return Wheel(joint, *place.at, radius, width, mass, source)


def _size(link: Link) -> tuple[float | None, float | None]:
    """Radius and width of the largest round shape of a link; None where it has none."""
    for shapes in (link.collision, link.visual):
        round_ = [shape for shape in shapes if shape.kind != "box"]
        if round_:
            largest = max(round_, key=lambda shape: shape.size[0])
            return largest.size[0], largest.size[1] if largest.kind == "cylinder" else None
    return None, None


def _solid_wheel(link: Link) -> tuple[float, float] | None:
    """Radius and width of a solid wheel with the inertia of a link: m r^2 / 2 and m (3 r^2 + w^2) / 12."""
    if link.inertia is None or link.inertia.mass <= 0.0:
        return None
    # The moment about the axle is the odd one out.
    low, middle, high = sorted(link.inertia.moments)
    axial, radial = (high, (low + middle) / 2.0) if high - middle >= middle - low else (low, (middle + high) / 2.0)
    radius = math.sqrt(max(0.0, 2.0 * axial / link.inertia.mass))
    width = math.sqrt(max(0.0, 12.0 * radial / link.inertia.mass - 3.0 * radius**2))
    return (radius, width) if 0.01 < radius < 1.0 and 0.002 < width < 2.0 * radius else None


def _is_upright(joint: Joint, places: Mapping[str, Pose]) -> bool:
    return abs(places[joint.child].turn(joint.axis)[2]) > _UPRIGHT


def _names_caster(joint: Joint) -> bool:
    return bool(_CASTER.search(joint.name) or _CASTER.search(joint.child))


def _swivels(description: Description, places: Mapping[str, Pose]) -> set[str]:
    """Links that turn with an upright axle, or hang on such links: what belongs to a swivelling caster."""
    found: set[str] = set()
    by_child = {joint.child: joint for joint in description.joints}
    for link in description.links:
        path = [link.name]
        while (joint := by_child.get(path[-1])) is not None:
            if joint.kind in ("continuous", "revolute") and _is_upright(joint, places):
                found.update(path)
            path.append(joint.parent)
    return found


def find_steering(description: Description) -> tuple[str, ...]:
    """The joints that steer wheels, as those of a car do: upright, with an end to their turn, and no casters'."""
    places = description.places()
    wheels = {
        joint.child
        for joint in description.joints
        if joint.kind in ("continuous", "revolute") and not _is_upright(joint, places)
    }
    return tuple(
        joint.name
        for joint in description.joints
        if joint.kind == "revolute"
        and _is_upright(joint, places)
        and not _names_caster(joint)
        and wheels & {each.child for each in description.joints if each.parent == joint.child}
    )


def _has_wheel_below(description: Description, name: str, wheels: set[str]) -> bool:
    """Return whether a link carries a wheel, as the fork of a caster does."""
    below, left = set(), [name]
    while left:
        own = left.pop()
        children = [joint.child for joint in description.joints if joint.parent == own]
        below.update(children)
        left += children
    return bool(below & wheels) or any(_CASTER.search(child) for child in below)
