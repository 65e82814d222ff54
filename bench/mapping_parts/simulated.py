"""Logs made by the project's simulator in lock step: a robot that knows the truth drives from goal to goal."""

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from bench.mapping_parts.lab import lab_goals, make_lab
from bench.mapping_parts.log import Floats, Log
from bench.navigation_parts.geodesic import free_cells, shortest_path
from bench.navigation_parts.worlds import GOALS
from numpy.typing import NDArray

from ur.robot.base import Base, load_base
from ur.worlds.world_file import WorldModel, read_world
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.simulator.simulation import Simulation

ROOT = Path(__file__).resolve().parents[2]
_PACKAGE = ROOT / "ubiquity_launches"
_CLEARANCE = 0.32  # m: the robot keeps its centre this far from walls
_AHEAD = 0.3  # m: it steers for the point of its path this far ahead
_SHARE = 0.9  # of the base's greatest speeds
WORLDS = ("office", "maze", "lab")


class Moment(NamedTuple):
    """A scan (beams) in m with its time in s, the pose of odometry, and the true one in the frame of the world."""

    stamp: float
    ranges: NDArray[np.float32]
    odometry: Pose2
    truth: Pose2


def read_bench_world(name: str, seed: int) -> tuple[WorldModel, list[tuple[float, float]]]:
    """Read a world and the goals of the drive through it; the seed shuffles the goals, and makes the lab."""
    random = np.random.default_rng(seed)
    if name == "lab":
        world = make_lab(seed)
        goals = [(float(x), float(y)) for x, y in lab_goals(world, random)]
    else:
        world = read_world(_PACKAGE / "n_simulator" / "worlds" / f"{name}.yaml")
        goals = [(x, y) for x, y, _ in GOALS[name]]
        if seed:
            goals = [goals[index] for index in random.permutation(len(goals))]
    return world, goals


def grid_of_world(world: WorldModel) -> Grid:
    """The floor plan as a grid."""
    plan = world.floor_plan
    return Grid(np.where(plan.walls, 100, 0).astype(np.int8), plan.resolution, Pose2(*plan.origin))


def load_bench_base(name: str = "stage") -> Base:
    """The base of that name without a variant."""
    return load_base(_PACKAGE, name, "")


def make_log(name: str, seed: int = 0, base_name: str = "stage") -> Log:
    """Drive through a world once. The same arguments give the same log."""
    base = load_bench_base(base_name)
    assert base.lidar is not None
    world, goals = read_bench_world(name, seed)
    grid = grid_of_world(world)
    moments = list(drive(Simulation(world, base, seed=seed), base, grid, goals))
    lidar = base.lidar
    return Log(
        name=name,
        stamps=np.array([each.stamp for each in moments]),
        ranges=np.array([each.ranges for each in moments]),
        angles=np.linspace(lidar.angle_min, lidar.angle_max, lidar.samples),
        mount=Pose2(lidar.pose[0], lidar.pose[1], lidar.pose[5]),
        range_limits=(lidar.range_min, lidar.range_max),
        odometry=np.array([each.odometry for each in moments]),
        reference=np.array([each.truth for each in moments]),
    )


def drive(simulation: Simulation, base: Base, grid: Grid, goals: Iterable[tuple[float, float]]) -> Iterator[Moment]:
    """Drive from goal to goal; yields what is measured with every scan."""
    for goal in goals:
        path = _path(grid, simulation.pose(0)[:2], goal)
        reached = 0
        while True:
            tick = simulation.advance()
            x, y, yaw = simulation.pose(0)
            if "scan" in tick.due:
                scan = simulation.scan(0).astype(np.float32)
                yield Moment(tick.time, scan, Pose2(*simulation.odometry(0).pose), Pose2(x, y, yaw))
            reached = _progress(path, reached, (x, y))
            if reached >= len(path) - 1 and math.hypot(*(path[-1] - (x, y))) < 0.1:
                break
            simulation.command(0, *_steer(base, path, reached, (x, y, yaw)))


def _path(grid: Grid, start: tuple[float, float], goal: tuple[float, float]) -> Floats:
    for clearance in (_CLEARANCE, 0.27, 0.22):
        corners = shortest_path(grid, free_cells(grid, clearance), start, goal)
        if corners is not None:
            break
    else:
        raise SystemExit(f"error: goal {goal}: there is no path to it, expected goals that can be reached")
    lengths = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))))
    places = np.linspace(0.0, lengths[-1], max(2, math.ceil(lengths[-1] / 0.05)))
    return np.column_stack([np.interp(places, lengths, corners[:, axis]) for axis in range(2)])


def _progress(path: Floats, reached: int, point: tuple[float, float]) -> int:
    """The first point of the path, from `reached` on, that is at least `_AHEAD` away; the last one at its end."""
    while reached < len(path) - 1 and math.hypot(*(path[reached] - point)) < _AHEAD:
        reached += 1
    return reached


def _steer(base: Base, path: Floats, reached: int, pose: tuple[float, float, float]) -> tuple[float, float]:
    """A velocity command towards a point of the path: turn on the spot first where it lies to the side."""
    dx, dy = path[reached] - pose[:2]
    bearing = wrap_angle(math.atan2(dy, dx) - pose[2])
    most_ahead, most_turn = _SHARE * base.limits.velocity, _SHARE * base.limits.angular_velocity
    turn = float(np.clip(2.5 * bearing, -most_turn, most_turn))
    ahead = 0.0 if abs(bearing) > 0.9 else most_ahead * math.cos(bearing) * min(1.0, math.hypot(dx, dy) / 0.3)
    return ahead, turn
