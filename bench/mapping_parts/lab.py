"""A world that is made anew from a seed: rooms along a corridor, turned so that no wall lies along the grid's axes."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ur.worlds.map_file import MapFile, MapImage
from ur.worlds.world_file import WorldModel

_CELL = 0.05
_LENGTH, _DEPTH = 14.0, 10.0  # m, of the building
_CORRIDOR = (4.2, 5.8)  # m, its two walls
_DOOR = 1.0  # m


def make_lab(seed: int) -> WorldModel:
    """Three rooms on each side of a corridor, with furniture, turned by an angle drawn from the seed."""
    random = np.random.default_rng(seed)
    cells = np.zeros((round(_DEPTH / _CELL), round(_LENGTH / _CELL)), dtype=bool)
    cells[:2] = cells[-2:] = True
    cells[:, :2] = cells[:, -2:] = True
    for wall, side in zip(_CORRIDOR, (-1, 1), strict=True):
        _fill(cells, 0.0, wall, _LENGTH, wall + 0.1)
        edges = [0.0, *(np.array((4.7, 9.4)) + random.uniform(-0.8, 0.8, 2)), _LENGTH]
        low, high = (0.0, wall) if side < 0 else (wall, _DEPTH)
        for left, right in pairwise(edges):
            _fill(cells, right - 0.1, low, right, high)
            door = random.uniform(left + 0.6, right - 0.6 - _DOOR)
            _fill(cells, door, wall, door + _DOOR, wall + 0.1, value=False)
            for _ in range(2):  # furniture along the outer wall, away from the door
                x = random.uniform(left + 0.3, right - 1.3)
                y = random.uniform(0.2, 1.0) if side < 0 else random.uniform(_DEPTH - 1.6, _DEPTH - 0.8)
                _fill(cells, x, y, x + random.uniform(0.3, 1.0), y + random.uniform(0.3, 0.6))
    yaw = float(random.uniform(0.25, 0.6))
    start = np.array((1.0, 5.05))
    c, s = math.cos(yaw), math.sin(yaw)
    origin = (-float(c * start[0] - s * start[1]), -float(s * start[0] + c * start[1]), yaw)
    file = MapFile(Path("lab.png"), _CELL, origin, negate=False, occupied_thresh=0.65, free_thresh=0.25, mode="trinary")
    plan = MapImage(file, np.where(cells, 100, 0).astype(np.int8))
    return WorldModel(plan, 1.0, 0.9, (), (), (0.0, 0.0, 0.0))


def lab_goals(world: WorldModel, random: np.random.Generator) -> NDArray[np.float64]:
    """The middle of each room, in an order drawn at random, and the start again; (n, 2) in the frame of the world."""
    rooms = np.array([(x, y) for x in (2.3, 7.0, 11.7) for y in (2.7, 7.3)])[random.permutation(6)]
    places = np.vstack((rooms, (1.0, 5.05)))
    x, y, yaw = world.floor_plan.origin
    c, s = math.cos(yaw), math.sin(yaw)
    return np.column_stack((x + c * places[:, 0] - s * places[:, 1], y + s * places[:, 0] + c * places[:, 1]))


def _fill(cells: NDArray[np.bool_], left: float, low: float, right: float, high: float, *, value: bool = True) -> None:
    columns, rows = [slice(round(a / _CELL), round(b / _CELL)) for a, b in ((left, right), (low, high))]
    cells[rows, columns] = value
