"""World and robots as a MuJoCo model (MJCF text).

Groups of shapes: lidars see 0 walls and boxes, 1 obstacles and people, 2 robots, but not 3 wheels and casters, 4 the
floor, 5 glass, which sonars detect.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ur.robot.base import Base
from ur.robot.base.outline import find_centroid
from ur.worlds.world_file import Box, WorldModel
from ur_nodes.geometry.pose import Pose2


class Rectangle(NamedTuple):
    """Cells from (`column`, `row`), `width` by `height` of them."""

    column: int
    row: int
    width: int
    height: int


def merge_cells(occupied: npt.NDArray[np.bool_]) -> tuple[Rectangle, ...]:
    """Rectangles that together cover each occupied cell exactly once and no other.

    Greedy: from each uncovered cell in reading order the larger of the widest and the tallest rectangle. Not the
    fewest possible, but near it for floor plans, in time linear in the cells.
    """
    left = occupied.copy()
    found: list[Rectangle] = []
    for row, column in zip(*np.nonzero(occupied), strict=True):
        if left[row, column]:
            part = left[row:, column:]
            wide, tall = _grow(part), _grow(part.T)
            width, height = wide if wide[0] * wide[1] >= tall[0] * tall[1] else (tall[1], tall[0])
            part[:height, :width] = False
            found.append(Rectangle(int(column), int(row), width, height))
    return tuple(found)


def _grow(part: npt.NDArray[np.bool_]) -> tuple[int, int]:
    """Width of the run at the start of the first row, and in how many rows it goes on."""
    width = _run(part[0, :])
    return width, _run(part[:, :width].all(axis=1))


def _run(line: npt.NDArray[np.bool_] | np.bool_) -> int:
    """Count the cells that are set before the first that is not."""
    return int(line.size if line.all() else np.argmin(line))


TIME_STEP = 0.005
GRAVITY = 9.81
LIDAR_GROUPS = (1, 1, 1, 0, 0, 0)
SONAR_GROUPS = (1, 1, 1, 0, 0, 1)

PERSON_RADIUS = 0.2
"""Half the width of a person, m."""

# Two shapes collide when one's type meets the other's affinity.
_WALL, _BODY, _OBSTACLE, _ROLLING, _PERSON = 1, 2, 4, 8, 16
_SCRAPE = 0.3  # friction of a chassis along a wall
_LIDAR_HEAD = 0.03  # a lidar's housing ends this far above its beams
_PERSON_SIDES = 8
_PERSON_HEIGHT = 1.7  # m
_WAITING_ROOM = 1000.0  # m: people are placed before the first step
_AT_REST = 1e-6  # m/s: what is slower, without a command, is not stepped
_GRIP = 0.4  # of the gain at which a servo that holds a velocity would oscillate


@dataclass(frozen=True, slots=True)
class Scenery:
    """MJCF for pictures only: before the assets, among them, in the world, and in each robot."""

    options: str = ""
    assets: str = ""
    shapes: str = ""
    robot: tuple[str, ...] = ()


def build_model(
    world: WorldModel, base: Base, robots: int, start: tuple[float, float, float], scenery: Scenery | None = None
) -> str:
    """Build the MJCF of a world with robots of one base; the first at `start`, the others behind it, out of reach.

    Names: bodies `robot_<n>` (origin on the ground between the wheels), `obstacle/<name>` and `person_<n>` (until they
    are moved they wait outside of the floor plan); shapes `chassis_<n>`, and `person_<n>`; joints `left_<n>` and
    `right_<n>`; actuators of the same names take wheel speeds in rad/s; sites `lidar_<n>`.
    A base that drives sideways has a joint `aside_<n>` that measures how far its wheels rolled to the left, with an
    actuator in m/s, and actuators `velocity_<n>/<axis>` (x, y: m/s, yaw: rad/s), which move it.
    With `scenery` the state means the same.
    """
    scenery = scenery or Scenery()
    top = max(base.height, base.lidar.pose[2] + _LIDAR_HEAD if base.lidar else 0.0)
    corners = " ".join(f"{x:g} {y:g} {z:g}" for z in (base.ground_clearance, top) for x, y in base.footprint)
    parts = [
        '<mujoco model="world"><compiler angle="radian" autolimits="true"/>',
        f'<option timestep="{TIME_STEP}" gravity="0 0 -{GRAVITY}" integrator="Euler" cone="elliptic"',
        f' sleep_tolerance="{_AT_REST}"><flag sleep="enable"/></option>',
        f'{scenery.options}<asset><mesh name="chassis" vertex="{corners}"/>{_person_mesh(world)}',
        f"{scenery.assets}</asset><worldbody>",
        f'<geom name="floor" type="plane" size="100 100 1" group="4" contype="0" conaffinity="{_OBSTACLE | _ROLLING}"'
        f' condim="3" priority="1" friction="{world.floor_friction:g} 0.005 0.0001"/>',
        *_walls(world),
        *(_box_geom(box, f"box/{box.name}") for box in world.boxes),
        *(_obstacle(box) for box in world.obstacles),
        *(_person(number) for number in range(world.people)),
        scenery.shapes,
        *(_robot(base, number, start_pose(base, number, start), scenery) for number in range(robots)),
        "</worldbody><actuator>",
        *_motors(base, robots, world.floor_friction),
        "</actuator></mujoco>",
    ]
    return "".join(parts)


def start_pose(base: Base, number: int, start: tuple[float, float, float]) -> Pose2:
    """Return the start pose of robot `number`: in a row along the heading of the first one."""
    pitch = 0.3 + max(x for x, _ in base.footprint) - min(x for x, _ in base.footprint)
    x, y, yaw = start
    return Pose2(x + math.cos(yaw) * pitch * number, y + math.sin(yaw) * pitch * number, yaw)


def _walls(world: WorldModel) -> Iterable[str]:
    plan = world.floor_plan
    for number, cells in enumerate(merge_cells(plan.walls)):
        middle = np.array((cells.row + (cells.height - 1) / 2.0, cells.column + (cells.width - 1) / 2.0))
        x, y = plan.points_of_cells(middle).tolist()
        pose = (x, y, world.wall_height / 2.0, plan.origin[2])
        size = (cells.width * plan.resolution, cells.height * plan.resolution, world.wall_height)
        yield _box_geom(Box(str(number), pose, size), f"wall/{number}")


def _box_geom(box: Box, name: str) -> str:
    x, y, z, yaw = box.pose
    return (
        f'<geom name="{escape(name)}" type="box" pos="{x!r} {y!r} {z!r}" euler="0 0 {yaw!r}" size="{_half(box)}"'
        f' contype="{_WALL}" conaffinity="0" friction="{_SCRAPE} 0.005 0.0001" group="{5 if box.glass else 0}"/>'
    )


def _obstacle(box: Box) -> str:
    x, y, z, yaw = box.pose
    name = f'"obstacle/{escape(box.name)}"'
    return (
        f'<body name={name} pos="{x!r} {y!r} {z!r}" euler="0 0 {yaw!r}"><freejoint name={name}/>'
        f'<geom name={name} type="box" size="{_half(box)}" mass="{box.mass!r}" contype="{_OBSTACLE}"'
        f' conaffinity="{_WALL | _BODY | _OBSTACLE}" friction="{_SCRAPE} 0.005 0.0001" group="1"/></body>'
    )


def _person_mesh(world: WorldModel) -> str:
    """Return the shape of a person: an upright prism."""
    if not world.people:
        return ""
    turns = [math.tau * number / _PERSON_SIDES for number in range(_PERSON_SIDES)]
    corners = [(PERSON_RADIUS * math.cos(turn), PERSON_RADIUS * math.sin(turn)) for turn in turns]
    points = " ".join(f"{x:.6f} {y:.6f} {z:g}" for z in (0.0, _PERSON_HEIGHT) for x, y in corners)
    return f'<mesh name="person" vertex="{points}"/>'


def _person(number: int) -> str:
    """Return the body of a person, which is moved from outside.

    It collides with robots only, and they do not push it.
    """
    return (
        f'<body name="person_{number}" mocap="true" pos="{_WAITING_ROOM + number!r} {_WAITING_ROOM!r} 0">'
        f'<geom name="person_{number}" type="mesh" mesh="person" rgba="0.3 0.4 0.6 1" contype="{_PERSON}"'
        f' conaffinity="0" friction="{_SCRAPE} 0.005 0.0001" group="1"/></body>'
    )


def _half(box: Box) -> str:
    return " ".join(repr(length / 2.0) for length in box.size)


def _robot(base: Base, number: int, pose: tuple[float, float, float], scenery: Scenery) -> str:
    x, y, yaw = pose
    mass = max(0.1 * base.mass, base.mass - 2.0 * base.wheels.mass)
    xs, ys = [p[0] for p in base.footprint], [p[1] for p in base.footprint]
    length, width = max(xs) - min(xs), max(ys) - min(ys)
    centre_x, centre_y = find_centroid(base.footprint)
    centre_z = base.ground_clearance + 0.4 * (base.height - base.ground_clearance)
    inertia = " ".join(
        f"{mass / 12.0 * (a * a + b * b)!r}" for a, b in ((width, base.height), (length, base.height), (length, width))
    )
    lidar = base.lidar.pose if base.lidar else (0.0,) * 6
    return (
        f'<body name="robot_{number}" pos="{x!r} {y!r} 0" euler="0 0 {yaw!r}" sleep="allowed">'
        f'<freejoint name="robot_{number}"/>'
        f'<inertial pos="{centre_x!r} {centre_y!r} {centre_z!r}" mass="{mass!r}" diaginertia="{inertia}"/>'
        f'<geom name="chassis_{number}" type="mesh" mesh="chassis" contype="{_BODY}"'
        f' conaffinity="{_WALL | _BODY | _OBSTACLE | _PERSON}" friction="{_SCRAPE} 0.005 0.0001" group="2"/>'
        f'<site name="lidar_{number}" pos="{" ".join(map(repr, lidar[:3]))}" euler="{" ".join(map(repr, lidar[3:]))}"/>'
        + "".join(scenery.robot[number : number + 1])
        + "".join(
            f'<geom type="sphere" pos="{caster.x!r} {caster.y!r} {caster.radius!r}" size="{caster.radius!r}"'
            f' condim="1" priority="2" contype="{_ROLLING}" conaffinity="0" group="3"/>'
            for caster in base.casters
        )
        + _wheel(base, f"left_{number}", base.wheels.separation / 2.0)
        + _wheel(base, f"right_{number}", -base.wheels.separation / 2.0)
        + _sideways(base, number)
        + "</body>"
    )


def _sideways(base: Base, number: int) -> str:
    """Return the point on the floor where the wheels of a base that drives sideways push, and a wheel that counts.

    Its other wheels carry it without friction, and turn as its motion ahead and its turns have it; what their rollers
    do is not modelled. The one that counts has no shape and no weight.
    """
    if not base.limits.sideways:
        return ""
    return (
        f'<site name="drive_{number}"/><body><joint name="aside_{number}" axis="0 0 1" armature="1"/>'
        '<inertial pos="0 0 0" mass="1e-6" diaginertia="1e-9 1e-9 1e-9"/></body>'
    )


def _wheel(base: Base, name: str, y: float) -> str:
    """Return a wheel that touches the floor at one point: an ellipsoid as wide as the wheel."""
    wheels = base.wheels
    smooth = ' condim="1" priority="2"' if base.limits.sideways else ""
    axial = wheels.mass * wheels.radius**2 / 2.0
    radial = wheels.mass * (3.0 * wheels.radius**2 + wheels.width**2) / 12.0
    return (
        f'<body pos="0 {y!r} {wheels.radius!r}"><joint name="{name}" axis="0 1 0" armature="{_rotor_inertia(base)!r}"/>'
        f'<inertial pos="0 0 0" mass="{wheels.mass!r}" diaginertia="{radial!r} {axial!r} {radial!r}"/>'
        f'<geom type="ellipsoid" size="{wheels.radius!r} {wheels.width / 2.0!r} {wheels.radius!r}"{smooth}'
        f' contype="{_ROLLING}" conaffinity="0" group="3"/></body>'
    )


def _motors(base: Base, robots: int, friction: float) -> Iterable[str]:
    """Return speed servos, strong enough to make a blocked wheel spin, and as stiff as explicit integration permits.

    Implicit integration would allow more, but MuJoCo solves for contact forces before it: the floor would push as if
    the motors were explicit, and throw the robot forward.
    """
    radius = base.wheels.radius
    gain = (_rotor_inertia(base) + base.wheels.mass * radius**2 / 2.0) / TIME_STEP * 0.8
    torque = 1.2 * friction * base.mass * GRAVITY / 2.0 * radius
    for number in range(robots):
        for side in ("left", "right"):
            name = f"{side}_{number}"
            yield f'<velocity name="{name}" joint="{name}" kv="{gain!r}" forcerange="{-torque!r} {torque!r}"/>'
        if base.limits.sideways:
            yield from _velocity_motors(base, number, friction)


def _velocity_motors(base: Base, number: int, friction: float) -> Iterable[str]:
    """Return servos that hold the velocity of a base, along x, along y and in turns, as far as its wheels grip."""
    yield f'<velocity name="aside_{number}" joint="aside_{number}" kv="{0.8 / TIME_STEP!r}"/>'
    grip = friction * base.mass * GRAVITY
    xs, ys = [p[0] for p in base.footprint], [p[1] for p in base.footprint]
    inertia = base.mass * ((max(xs) - min(xs)) ** 2 + (max(ys) - min(ys)) ** 2) / 12.0
    for axis, gear, weight, most in (
        ("x", "1 0 0 0 0 0", base.mass, grip),
        ("y", "0 1 0 0 0 0", base.mass, grip),
        ("yaw", "0 0 0 0 0 1", inertia, grip * base.wheels.separation / 2.0),
    ):
        yield (
            f'<velocity name="velocity_{number}/{axis}" site="drive_{number}" gear="{gear}"'
            f' kv="{_GRIP * weight / TIME_STEP!r}" forcerange="{-most!r} {most!r}"/>'
        )


def _rotor_inertia(base: Base) -> float:
    """Rotor inertia reflected to the wheel, kg m^2: a fraction of the larger of translational and turning inertia."""
    xs, ys = [p[0] for p in base.footprint], [p[1] for p in base.footprint]
    about_axle = ((max(xs) - min(xs)) ** 2 + (max(ys) - min(ys)) ** 2) / 12.0 + find_centroid(base.footprint)[0] ** 2
    in_turns = about_axle / (base.wheels.separation / 2.0) ** 2  # what a kilogram counts at the wheels
    return 0.3 * base.mass / 2.0 * max(1.0, in_turns) * base.wheels.radius**2
