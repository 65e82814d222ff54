"""Properties of a base in a robot description: wheels, heights, masses, speeds."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ur.robot.description.drive import DriveGeometry
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
    if not missing:
        return ()
    names = " and ".join(f"{key.replace('_', ' ')} {usual[key]:g} {_UNITS[key]}" for key in missing)
    return (f"{names}: usual, as neither the description nor a file around it says; change `limits` in base.yaml",)


def _limited(figure: Figure, most: float, unit: str) -> Figure:
    if figure.value <= most:
        return figure
    return Figure(most, f"{figure.source}: {figure.value:g} {unit}; this is the most that a base may have")
