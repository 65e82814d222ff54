"""Flats that are made anew from a seed: rooms off a hall, doors of several widths, furniture."""

from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ur.worlds.map_file import MapFile, MapImage
from ur.worlds.world_file import WorldModel

_CELL = 0.05
_WALL = 0.1  # m
_HALL = 1.6  # m, its width
_DOORS = (0.8, 0.9, 1.0)  # m, what standards of houses name
START_AT = 0.9  # m from the hall's end: the origin of the world


def make_flat(seed: int) -> WorldModel:
    """A hall with two or three rooms on each side, some of them joined by a second door, with furniture."""
    random = np.random.default_rng(1000 + seed)
    length, low_depth, high_depth = random.uniform(8.5, 12.0), random.uniform(3.0, 4.5), random.uniform(3.0, 4.5)
    depth = low_depth + _HALL + high_depth
    cells = np.zeros((round(depth / _CELL), round(length / _CELL)), dtype=bool)
    cells[:2] = cells[-2:] = True
    cells[:, :2] = cells[:, -2:] = True
    for wall, low, high in ((low_depth, 0.0, low_depth), (low_depth + _HALL, low_depth + _HALL, depth)):
        _fill(cells, 0.0, wall - _WALL / 2, length, wall + _WALL / 2)
        count = int(random.integers(2, 4))
        edges = np.linspace(0.0, length, count + 1)
        edges[1:-1] += random.uniform(-0.5, 0.5, count - 1)
        for left, right in pairwise(edges.tolist()):
            if right < length - 0.1:
                _fill(cells, right - _WALL / 2, low, right + _WALL / 2, high)
            door = float(random.choice(_DOORS))
            at = random.uniform(left + 0.4, right - 0.4 - door)
            _fill(cells, at, wall - _WALL, at + door, wall + _WALL, value=False)
            _furnish(cells, random, (left, low, right, high), toward_high=wall == low)
        if count == 3 and random.random() < 0.7:  # a second door between two rooms
            side = float(edges[int(random.integers(1, count))])
            at = (low + high) / 2.0 - 0.45
            _fill(cells, side - _WALL, at, side + _WALL, at + 0.9, value=False)
    origin = (-START_AT, -(low_depth + _HALL / 2), 0.0)
    file = MapFile(
        Path("flat.png"), _CELL, origin, negate=False, occupied_thresh=0.65, free_thresh=0.25, mode="trinary"
    )
    return WorldModel(MapImage(file, np.where(cells, 100, 0).astype(np.int8)), 1.0, 0.9, (), (), (0.0, 0.0, 0.0))


def write_flat(seed: int, folder: Path) -> Path:
    """Write a flat as a world file with its image; returns the former."""
    from PIL import Image

    plan = make_flat(seed).floor_plan
    name = f"flat_{seed}"
    Image.fromarray(np.where(plan.values[::-1] > 0, 0, 254).astype(np.uint8)).save(folder / f"{name}.png")
    origin = ", ".join(f"{value:g}" for value in plan.origin)
    file = folder / f"{name}.yaml"
    file.write_text(
        f"image: {name}.png\nresolution: {_CELL}\norigin: [{origin}]\nnegate: 0\noccupied_thresh: 0.65\n"
        "free_thresh: 0.25\n"
    )
    return file


def _furnish(
    cells: NDArray[np.bool_],
    random: np.random.Generator,
    room: tuple[float, float, float, float],
    *,
    toward_high: bool,
) -> None:
    """A bed or a cupboard along the outer wall, and a table with space round it where the room has that."""
    left, low, right, high = room
    wide, deep = random.uniform(0.8, 1.8), random.uniform(0.4, 0.9)
    x = random.uniform(left + 0.1, max(left + 0.2, right - 0.1 - wide))
    y = high - deep if toward_high else low
    _fill(cells, x, y, x + wide, y + deep)
    if right - left < 3.0 or high - low < 2.8:
        return
    middle = ((left + right) / 2 + random.uniform(-0.2, 0.2), (low + high) / 2)
    size = random.uniform(0.25, 0.45)
    _fill(cells, middle[0] - size, middle[1] - size / 2, middle[0] + size, middle[1] + size / 2)


def _fill(cells: NDArray[np.bool_], left: float, low: float, right: float, high: float, *, value: bool = True) -> None:
    columns, rows = [slice(max(0, round(a / _CELL)), round(b / _CELL)) for a, b in ((left, right), (low, high))]
    cells[rows, columns] = value
