"""The worlds, and the goals of each: x, y in m in the frame of the world, heading in degrees.

Those of `maze` and `office` were drawn once at random: at least 0.32 m from any obstacle, 6 to 20 m of shortest way
from one to the next (the first from the start at the origin), any heading; then rounded and written down. Those of
generated flats are drawn likewise from the number of the flat, from 3 m on.
"""

import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from bench.exploration_parts.flat import write_flat
from bench.navigation_parts.geodesic import free_cells, length_of, shortest_path
from bench.navigation_parts.stack import MAPS
from scipy.ndimage import label

from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.grid import Grid, load_map

_ROOM = 0.05  # m beside the farthest corner of a robot that turns
_CLEAR = 0.32  # m from a goal to any obstacle
_COUNT = 10
_FAR = 3.0  # m from the start that a base must get
_WAYS = (3.0, 20.0)  # m from one goal of a flat to the next
_FLAT = re.compile(r"flat_(\d{1,4})")

Goal = tuple[float, float, float]

GOALS: dict[str, tuple[Goal, ...]] = {
    "maze": (
        (7.87, 1.53, -140),
        (2.03, 7.62, -160),
        (7.23, 10.63, 160),
        (2.03, 13.83, 40),
        (0.03, 1.68, 0),
        (6.08, 3.08, 60),
        (11.88, 13.83, 170),
        (7.18, 4.18, 10),
        (7.43, 13.38, 30),
        (10.83, 10.18, -100),
    ),
    "office": (
        (5.88, 6.47, 160),
        (8.03, -6.43, -120),
        (10.73, 1.47, -60),
        (14.28, 2.43, -140),
        (14.18, -5.22, 140),
        (8.48, -2.53, 120),
        (8.23, 4.22, 180),
        (13.93, -0.12, 10),
        (9.83, 3.22, -90),
        (12.28, -1.97, -30),
    ),
}

OBSTACLE_GOALS = (1, 4, 7)
"""The goals (from 0) during which an obstacle appears on the way, with --obstacles."""


@dataclass(frozen=True, slots=True, eq=False)
class BenchWorld:
    """A world: its name, the value of the launch argument `world`, its walls, and its goals."""

    name: str
    source: str
    grid: Grid
    goals: tuple[Goal, ...]


def is_world(name: str) -> bool:
    """Tell whether there is such a world: `maze`, `office`, or `flat_N`."""
    return name in GOALS or _FLAT.fullmatch(name) is not None


def find_world(name: str, directory: Path) -> BenchWorld:
    """Return a world by name; a flat is made anew in `directory`."""
    if name in GOALS:
        return BenchWorld(name, name, load_map(MAPS / f"{name}.yaml"), GOALS[name])
    number = int(name.removeprefix("flat_"))
    file = write_flat(number, directory)
    grid = load_map(file)
    return BenchWorld(name, str(file), grid, draw_goals(grid, number))


def draw_goals(grid: Grid, seed: int) -> tuple[Goal, ...]:
    """Draw goals on the floor that can be reached from the origin. The same arguments give the same goals."""
    random = np.random.default_rng(seed)
    free = free_cells(grid, _CLEAR)
    places = grid.points_of_cells(np.argwhere(free))
    goals: list[Goal] = []
    here = (0.0, 0.0)
    for x, y in places[random.permutation(len(places))].tolist():
        way = shortest_path(grid, free, here, (x, y))
        if way is None or not _WAYS[0] <= length_of(way) <= _WAYS[1]:
            continue
        here = (round(x, 2), round(y, 2))
        goals.append((*here, float(10 * random.integers(-17, 19))))
        if len(goals) == _COUNT:
            break
    return tuple(goals)


def passage_radius(footprint: Footprint) -> float:
    """Half the width of the narrowest passage that a robot can drive through, m; it moves along x only."""
    ys = footprint.outline[:, 1]
    return max(footprint.inscribed, float(ys.max() - ys.min()) / 2.0)


def refuse_size(world: BenchWorld, base: str, footprint: Footprint) -> str:
    """Return an error for a base that cannot leave the start of a world, '' for one that can."""
    radius = passage_radius(footprint)
    pieces, _ = label(free_cells(world.grid, radius))
    start = int(pieces[tuple(world.grid.cells_of_points(np.zeros(2)))])
    places = world.grid.points_of_cells(np.argwhere(pieces == start)) if start else np.zeros((1, 2))
    farthest = float(np.hypot(*places.T).max())
    if farthest >= _FAR:
        return ""
    return (
        f"error: {base} is too large for {world.name}: it needs passages of {2.0 * radius:.2f} m, and gets"
        f" {farthest:.1f} m from the start; expected a smaller base or a larger world"
    )


def fit_goals(goals: tuple[Goal, ...], grid: Grid, footprint: Footprint) -> tuple[Goal, ...]:
    """Move goals at which the robot cannot turn, or to which it cannot get from the origin, to the next such place.

    Goals of robots that are no larger than those which the goals were drawn for stay as they are.
    """
    free = free_cells(grid, footprint.circumscribed + _ROOM)
    pieces, _ = label(free_cells(grid, passage_radius(footprint) + _ROOM))
    start = pieces[tuple(grid.cells_of_points(np.zeros(2)))]
    places = grid.points_of_cells(np.argwhere(free & (pieces == start) & (start > 0)))
    if not len(places):
        return goals
    fitted = []
    for x, y, heading in goals:
        distances = np.hypot(*(places - (x, y)).T)
        nearest = int(distances.argmin())
        if distances[nearest] > math.sqrt(0.5) * grid.resolution + 1e-6:
            x, y = (round(float(value), 2) for value in places[nearest])
        fitted.append((x, y, heading))
    return tuple(fitted)
