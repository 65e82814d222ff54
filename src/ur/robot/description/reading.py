"""Derivation of a base's properties from a robot description, and the questions about missing ones.

The origin of a base is on the ground between the driven wheels; a robot with several driven axles (skid steer) becomes
one with two driven wheels between them and a passive support below the first and the last axle.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ur.robot.base.outline import Point, find_centroid, is_inside
from ur.robot.description.drive import DriveGeometry, find_drive, find_steering
from ur.robot.description.outlines import Extent, draw_outline, measure_extent
from ur.robot.description.pose import Pose, make_pose
from ur.robot.description.sensing import FoundSensor, find_sensors, list_extra_sensors
from ur.robot.description.speed_files import FoundSpeeds
from ur.robot.description.urdf_parts import Description

HIGHEST_VELOCITY = 3.0  # m/s, and rad/s below
HIGHEST_ANGULAR_VELOCITY = 1.5
_BRAKING, _HARDEST = 2.0, 6.0  # m/s^2: the usual deceleration, and the highest that wheels can pass to a floor
_UNITS = {"velocity": "m/s", "angular_velocity": "rad/s"}


@dataclass(frozen=True, slots=True)
class Figure:
    """A value and its source."""

    value: float
    source: str


def read_wheels(description: Description, drive: DriveGeometry, figures: dict[str, Figure]) -> None:
    """Read radius, separation and width of the wheels."""
    known = [wheel for wheel in drive.wheels if wheel.radius]
    if known:
        radius = sum(wheel.radius or 0.0 for wheel in known) / len(known)
        figures.setdefault("wheel_radius", Figure(radius, known[0].source))
    if drive.wheels:
        sides = [sum(wheel.y for wheel in side) / len(side) for side in (drive.left, drive.right)]
        source = f"joints {drive.left[0].joint.name} and {drive.right[0].joint.name}"
        figures.setdefault("wheel_separation", Figure(sides[0] - sides[1], source))
    elif description.drive:
        plugin = description.drive
        for key, value in (("wheel_radius", plugin.radius), ("wheel_separation", plugin.separation)):
            if value is not None:
                figures.setdefault(key, Figure(value, "gazebo plugin"))
    widths = [wheel.width for wheel in drive.wheels if wheel.width and wheel.width >= 0.001]
    if widths:
        figures["wheel_width"] = Figure(max(widths), f"link {drive.wheels[0].joint.child}")
    elif "wheel_radius" in figures:
        figures["wheel_width"] = Figure(min(0.03, figures["wheel_radius"].value), "usual")


def read_heights(figures: dict[str, Figure], heights: Sequence[float]) -> None:
    """Read height and ground clearance from the heights of points."""
    if heights and max(heights) >= 0.02:
        figures.setdefault("height", Figure(max(heights), "shapes and meshes of what is fixed to the base"))
    radius = figures["wheel_radius"].value if "wheel_radius" in figures else 0.06
    clearance = Figure(min(0.03, radius / 2.0), "usual")
    if heights and min(heights) >= 0.005:
        clearance = Figure(min(heights), "lowest shape of the base")
    if "height" in figures:
        clearance = replace(clearance, value=max(0.001, min(clearance.value, figures["height"].value - 0.01)))
    figures["ground_clearance"] = clearance


def read_masses(description: Description, drive: DriveGeometry, figures: dict[str, Figure]) -> None:
    """Read the masses of robot and wheels."""
    wheels = {wheel.joint.child for wheel in drive.wheels}
    masses = {link.name: link.inertia.mass for link in description.links if link.inertia}
    body = sum(mass for name, mass in masses.items() if name not in wheels)
    if body >= 0.01:  # else only its wheels have a mass
        figures.setdefault("mass", Figure(sum(masses.values()), "sum of all links"))
    if "mass" in figures:
        usual = Figure(figures["mass"].value / 20.0, "usual")
        each_side = sum(wheel.mass for wheel in drive.wheels) / 2.0
        fits = 0.001 <= each_side <= 0.4 * figures["mass"].value
        figures["wheel_mass"] = Figure(each_side, "inertia of the wheels") if fits else usual


def read_limits(
    description: Description, drive: DriveGeometry, figures: dict[str, Figure], speeds: FoundSpeeds | None = None
) -> tuple[str, ...]:
    """Read the speed limits of a Gazebo plugin, else of joints, else take those of files or usual ones.

    Implausibly high limits are ignored. Returns notes for the user.
    """
    plugin = description.drive
    turns = [wheel.joint.velocity for wheel in drive.wheels]
    of_joints = [speed for speed in turns if speed is not None and speed > 0.0]
    radius, separation = figures.get("wheel_radius"), figures.get("wheel_separation")
    velocity = Figure(plugin.velocity, "gazebo plugin") if plugin and plugin.velocity else None
    if velocity is None and of_joints and radius and min(of_joints) * radius.value <= HIGHEST_VELOCITY:
        velocity = Figure(min(of_joints) * radius.value, f"limit of joint {drive.wheels[0].joint.name}")
    turning = Figure(plugin.angular_velocity, "gazebo plugin") if plugin and plugin.angular_velocity else None
    if (velocity is None or velocity.value < 0.05) and speeds:
        velocity = Figure(speeds.velocity, speeds.source)
        turning = turning or (Figure(speeds.angular_velocity, speeds.source) if speeds.angular_velocity else None)
    if velocity and velocity.value >= 0.05:
        figures.setdefault("velocity", _limited(velocity, HIGHEST_VELOCITY, "m/s"))
        if turning is None and separation:
            turning = Figure(2.0 * velocity.value / separation.value, "velocity and separation of the wheels")
    if turning and turning.value >= 0.2:
        figures.setdefault("angular_velocity", _limited(turning, HIGHEST_ANGULAR_VELOCITY, "rad/s"))
    acceleration = Figure(plugin.acceleration, "gazebo plugin") if plugin and plugin.acceleration else None
    if acceleration is None and speeds and speeds.acceleration:
        acceleration = Figure(speeds.acceleration, speeds.source)
    plausible = acceleration is not None and 0.2 <= acceleration.value <= 1.5
    figures["acceleration"] = acceleration if acceleration and plausible else Figure(0.8, "usual")
    braking = Figure(speeds.deceleration, speeds.source) if speeds and speeds.deceleration else None
    plausible = braking is not None and figures["acceleration"].value <= braking.value <= _HARDEST
    figures["deceleration"] = braking if braking and plausible else Figure(_BRAKING, "usual")
    usual = {"velocity": 0.5, "angular_velocity": 1.5}
    missing = [key for key in usual if key not in figures]
    figures.update({key: Figure(usual[key], "usual") for key in missing})
    if speeds and (own := speeds.navigation):
        for key, value, least in (("velocity", own.velocity, 0.05), ("angular_velocity", own.angular_velocity, 0.2)):
            if value and least <= value < figures[key].value:
                figures[f"navigation_{key}"] = Figure(value, own.source)
    if not missing:
        return ()
    names = " and ".join(f"{key.replace('_', ' ')} {usual[key]:g} {_UNITS[key]}" for key in missing)
    return (f"{names}: usual, as neither the description nor a file around it says; change `limits` in base.yaml",)


def _limited(figure: Figure, most: float, unit: str) -> Figure:
    if figure.value <= most:
        return figure
    return Figure(most, f"{figure.source}: {figure.value:g} {unit}; this is the most that a base may have")


BRAKING = 0.13  # s from full speed to rest, so that a robot stops within 0.3 s of its last command
SHORT_STOP = 0.6  # m/s: any robot can brake from it in that time without sliding
# The least and the greatest value of a base; others in a description count as errors, and the user is asked instead.
QUESTIONS: Mapping[str, tuple[float, float]] = {
    "length": (0.01, 10.0),
    "width": (0.01, 10.0),
    "height": (0.02, 10.0),
    "mass": (0.05, 10000.0),
    "wheel_radius": (0.005, 2.0),
    "wheel_separation": (0.02, 10.0),
    "velocity": (0.05, HIGHEST_VELOCITY),
    "angular_velocity": (0.1, HIGHEST_ANGULAR_VELOCITY),
    "lateral_velocity": (0.0, HIGHEST_VELOCITY),
}
# Instructions for the user to measure each of them.
MEASURES: Mapping[str, str] = {
    "length": "from its foremost to its rearmost part, with wheels, bumpers and cables",
    "width": "from its leftmost to its rightmost part, with the wheels",
    "height": "from the floor to its highest part",
    "mass": "on scales, with its battery",
    "wheel_radius": "half the height of a driven wheel that carries the robot",
    "wheel_separation": "between the middles of the left and the right tyre, on the floor",
    "velocity": "drive 2 m at full speed: 2 divided by the seconds; a lower one if it is to drive slower",
    "angular_velocity": "turn it ten times on the spot: 63 divided by the seconds; a lower one if it is to turn slower",
    "lateral_velocity": "drive 2 m to the side at full speed: 2 divided by the seconds",
}
_SIDEWAYS = re.compile(r"mecanum|omni", re.IGNORECASE)
_MOST_LENGTH, _MOST_WIDTH = 4.0, 2.2  # of a body, in multiples of its wheel separation


@dataclass(frozen=True, slots=True)
class Support:
    """A passive support, at (x, y) of the base."""

    x: float
    y: float
    radius: float
    source: str


@dataclass(frozen=True, slots=True)
class DescriptionReading:
    """The properties of a base from a description, in `base_footprint`.

    `open` are the names of QUESTIONS that the description does not answer. `outline` and `body` are () while length or
    width is open. `notes` are remarks for the user.
    """

    name: str
    figures: Mapping[str, Figure]
    open: tuple[str, ...]
    outline: tuple[Point, ...]
    body: tuple[Point, ...]
    supports: tuple[Support, ...]
    sensors: tuple[FoundSensor, ...]
    notes: tuple[str, ...]

    @property
    def navigation(self) -> tuple[float, float]:
        """The highest velocity and angular velocity of navigation, m/s and rad/s."""
        figures = self.figures
        keys = ("velocity", "angular_velocity")
        velocity, turning = (figures.get(f"navigation_{key}", figures[key]).value for key in keys)
        return velocity, turning

    @property
    def has_lidar(self) -> bool:
        """True if the robot has a lidar."""
        return any(sensor.kind == "lidar" for sensor in self.sensors)


def read_base_figures(
    description: Description,
    given: Mapping[str, float],
    *,
    lidar: bool | None = None,
    speeds: FoundSpeeds | None = None,
) -> DescriptionReading:
    """Derive the properties of a base from its description; `given` values (names of QUESTIONS) take precedence.

    `speeds` are those of files around it, for a description that names none.
    With `lidar` True, a robot whose description names no lidar gets a typical one on top; with False it has none.
    """
    drive = find_drive(description)
    sensors = _choose_sensors(description, lidar)
    wheels = {wheel.joint.child for wheel in drive.wheels}
    figures = {key: Figure(value, "given") for key, value in given.items()}
    read_wheels(description, drive, figures)
    origin = _find_origin(description, drive, figures)
    aside = {sensor.link for sensor in sensors} | {support.link for support in drive.casters} | wheels
    body = measure_extent(description, aside)
    if _is_too_large(body, figures):  # many inertias are copied from another robot
        body = measure_extent(description, aside, careful=True)
    points = [(x - origin[0], y - origin[1], z - origin[2]) for x, y, z in body.points]
    meshes = {link.name: link.meshes[0].file for link in description.links if link.meshes}
    notes = [
        f"link {name} is a mesh that cannot be read ({meshes[name]}); its size is that of a solid box with its inertia"
        for name in body.estimated
    ]
    notes += [
        f"link {name} is a mesh without a size, as it cannot be read ({meshes[name]}); it is left out"
        for name in body.unknown
    ]
    outline, inner = _read_outline(drive, figures, [(x, y) for x, y, _ in points], origin)
    read_heights(figures, [z for _, _, z in points])
    read_masses(description, drive, figures)
    notes += _read_speeds(description, drive, figures, speeds)
    supports = _read_supports(drive, figures, outline, origin)
    if len({round(wheel.x, 3) for wheel in drive.wheels}) > 1:
        notes.append("several driven axles (skid steer): simulated as two driven wheels between them")
    if steering := find_steering(description, drive):
        joints = " and ".join(steering)
        notes.append(f"it steers by {joints}, as a car does; the base turns on the spot, which this robot cannot")
    extra = list_extra_sensors(description, sensors)
    placed = tuple(replace(each, pose=_moved(each.pose, origin)) for each in sensors)
    if lidar and not any(each.kind == "lidar" for each in sensors):
        placed = (_add_lidar(description, figures, outline), *placed)
    notes += [_describe_depth(each, sensors) for each in sensors if each.depth and each.kind == "camera"]
    if extra:
        notes.append(f"left out, since a base has no such sensor, or another one of its kind: {', '.join(extra)}")
    return DescriptionReading(
        description.name,
        figures,
        tuple(key for key, ends in QUESTIONS.items() if key not in figures or not _fits(figures[key], ends)),
        outline,
        inner,
        supports,
        placed,
        tuple(notes),
    )


def _choose_sensors(description: Description, lidar: bool | None) -> tuple[FoundSensor, ...]:
    """Find the sensors; without the lidar if there shall be none, and without one of depths if there shall be one."""
    found = find_sensors(description)
    return tuple(each for each in found if lidar is None or each.kind != "lidar" or (lidar and not each.depth))


def _read_speeds(
    description: Description, drive: DriveGeometry, figures: dict[str, Figure], speeds: FoundSpeeds | None
) -> tuple[str, ...]:
    """Read what limits the motion, to the side too; return notes."""
    notes = read_limits(description, drive, figures, speeds)
    sideways = description.sideways or any(_SIDEWAYS.search(f"{w.joint.name} {w.joint.child}") for w in drive.wheels)
    if sideways:
        figures.setdefault("lateral_velocity", replace(figures["velocity"], source="as ahead: it can drive sideways"))
    figures.setdefault("lateral_velocity", Figure(0.0, "usual"))
    if max(figures["velocity"].value, figures["lateral_velocity"].value) <= SHORT_STOP:
        figures.pop("deceleration")  # it brakes harder than its files ask for
    return notes


def _is_too_large(body: Extent, figures: Mapping[str, Figure]) -> bool:
    """Return whether a body is implausibly large compared with the wheel separation."""
    if "wheel_separation" not in figures or not body.points:
        return False
    length, width = (_span([(x, y) for x, y, _ in body.points], axis) for axis in (0, 1))
    return max(length / _MOST_LENGTH, width / _MOST_WIDTH) > figures["wheel_separation"].value


def _fits(figure: Figure, ends: tuple[float, float]) -> bool:
    return ends[0] <= figure.value <= ends[1]


def _find_origin(
    description: Description, drive: DriveGeometry, figures: Mapping[str, Figure]
) -> tuple[float, float, float]:
    """Return the point on the ground between the driven wheels, in the root link."""
    if drive.wheels:
        xs, ys, zs = ([getattr(wheel, axis) for wheel in drive.wheels] for axis in "xyz")
        radius = figures["wheel_radius"].value if "wheel_radius" in figures else 0.0
        return (max(xs) + min(xs)) / 2.0, (max(ys) + min(ys)) / 2.0, sum(zs) / len(zs) - radius
    lowest = min((z for _, _, z in measure_extent(description, ()).points), default=0.0)
    return 0.0, 0.0, lowest


def _read_outline(
    drive: DriveGeometry, figures: dict[str, Figure], points: Sequence[Point], origin: Sequence[float]
) -> tuple[tuple[Point, ...], tuple[Point, ...]]:
    inner = draw_outline(points)
    sizes: dict[str, float] = {}
    for axis, key in enumerate(("length", "width")):
        if inner:
            figures.setdefault(key, Figure(_span(inner, axis), "shapes and meshes of what is fixed to the base"))
        if key in figures:
            sizes[key] = figures[key].value
    if len(sizes) < 2:
        return (), ()
    if any(figures[key].source == "given" for key in sizes):
        x, y = ((max(p[axis] for p in inner) + min(p[axis] for p in inner)) / 2.0 if inner else 0.0 for axis in (0, 1))
        half, side = sizes["length"] / 2.0, sizes["width"] / 2.0
        corners = [(half, -side), (half, side), (-half, side), (-half, -side)]
        inner = draw_outline((x + dx, y + dy) for dx, dy in corners)
    if "wheel_radius" not in figures or "wheel_separation" not in figures:
        return inner, ()
    radius, side = figures["wheel_radius"].value, figures["wheel_separation"].value / 2.0
    half = figures["wheel_width"].value / 2.0
    axles = {wheel.x - origin[0] for wheel in drive.wheels} | {0.0}
    tyres = [(x + dx, y + dy) for x in axles for y in (side, -side) for dx in (radius, -radius) for dy in (half, -half)]
    outline = draw_outline([*inner, *tyres])
    return outline, inner if outline != inner else ()


def _describe_depth(camera: FoundSensor, sensors: Sequence[FoundSensor]) -> str:
    scan = any(each.depth and each.kind == "lidar" for each in sensors)
    use = "a scan in place of a lidar's (on the robot: n_depthimage_to_laserscan)" if scan else "not"
    return f"camera {camera.frame} is a depth camera: its picture is simulated, its depth is {use}"


def _span(points: Sequence[Point], axis: int) -> float:
    return max(point[axis] for point in points) - min(point[axis] for point in points)


def _read_supports(
    drive: DriveGeometry, figures: Mapping[str, Figure], outline: Sequence[Point], origin: Sequence[float]
) -> tuple[Support, ...]:
    """Return the casters, or the outer axles of a skid steer; default supports if the robot would tip over."""
    if not outline or "wheel_radius" not in figures or "wheel_separation" not in figures:
        return ()
    most = figures["wheel_radius"].value
    usual = min(0.02, most / 2.0)
    found = [
        Support(
            c.x - origin[0],
            c.y - origin[1],
            min(c.radius, most) if c.radius and c.radius >= 0.001 else usual,
            f"link {c.link}",
        )
        for c in drive.casters
        if abs(c.x - origin[0]) > 0.005
    ]
    axles = sorted({round(wheel.x - origin[0], 4) for wheel in drive.wheels})
    if len(axles) > 1 and axles[-1] - axles[0] > 0.02:
        found += [Support(x, 0.0, usual, "below an axle") for x in (axles[-1], axles[0])]
    side = figures["wheel_separation"].value / 2.0
    x0, y0 = find_centroid(outline)
    xs = [x for x, _ in outline]
    for end in (min(xs), max(xs)):
        ground = [(0.0, side), (0.0, -side), *((support.x, support.y) for support in found)]
        leans = (x0 + math.copysign(0.01, end), y0)
        if not found or not is_inside(leans, ground, 0.0):
            found.append(Support(round(0.75 * end, 3), 0.0, usual, "usual: the description has none there"))
    return tuple(found)


def _add_lidar(description: Description, figures: Mapping[str, Figure], outline: Sequence[Point]) -> FoundSensor:
    names = {link.name for link in description.links}
    frame = next(name for name in ("laser", "lidar", "top_laser", "laser_of_ur") if name not in names)
    x = find_centroid(outline)[0] if outline else 0.0
    height = figures["height"].value if "height" in figures else 0.3
    return FoundSensor("lidar", frame, frame, make_pose((x, 0.0, height + 0.05), (0.0, 0.0, 0.0)), "given: on top")


def _moved(pose: Pose, origin: tuple[float, float, float]) -> Pose:
    x, y, z = pose.at
    return Pose((x - origin[0], y - origin[1], z - origin[2]), pose.rotation)
