"""Scenes for driving by hand: a room with something in it, and a corridor of 1 m."""

import math
from pathlib import Path

import numpy as np

from ur.worlds.map_file import MapFile, MapImage
from ur.worlds.world_file import Box, WorldModel

SCENES = ("wall", "box", "person", "pole", "stepping in")
_CELL = 0.05
ROOM = 6.0  # m
CORRIDOR = (9.0, 1.0)  # m
STEPPER = "person"


def make_scene(kind: str, random: np.random.Generator, farther: float = 0.0) -> WorldModel:
    """A square room with its middle at the origin, and what stands 1.2 to 1.8 m from there in some direction.

    All is `farther` (m) from the origin, for a base that needs a way to get fast.
    """
    angle, distance, room = random.uniform(-math.pi, math.pi), random.uniform(1.2, 1.8) + farther, ROOM + 2.0 * farther
    x, y, yaw = distance * math.cos(angle), distance * math.sin(angle), random.uniform(-math.pi, math.pi)
    boxes: tuple[Box, ...] = ()
    obstacles: tuple[Box, ...] = ()
    if kind == "box":
        size = random.uniform(0.15, 0.6, 2)
        boxes = (Box("box", (x, y, 0.5, yaw), (float(size[0]), float(size[1]), 1.0)),)
    elif kind == "person":  # two legs
        aside = 0.12 * math.cos(yaw), 0.12 * math.sin(yaw)
        boxes = tuple(
            Box(f"leg_{sign}", (x + sign * aside[0], y + sign * aside[1], 0.5, yaw), (0.1, 0.1, 1.0))
            for sign in (-1, 1)
        )
    elif kind == "pole":
        boxes = (Box("pole", (x, y, 0.5, yaw), (0.04, 0.04, 1.0)),)
    elif kind == "stepping in":
        obstacles = (Box(STEPPER, (room / 2.0 - 0.4, room / 2.0 - 0.4, 0.51, 0.0), (0.25, 0.25, 1.0), 60.0),)
    side = 1.6 + farther if kind == "wall" else room / 2.0  # m from the middle to each wall
    cells = np.ones((round(room / _CELL) + 4,) * 2, bool)
    edge = round((room / 2.0 - side) / _CELL) + 2
    cells[edge:-edge, edge:-edge] = False
    start = 0.0, 0.0, angle + random.uniform(-0.3, 0.3)
    return _world(cells, (-room / 2.0 - 2 * _CELL,) * 2, boxes, obstacles, start)


def make_corridor(random: np.random.Generator) -> WorldModel:
    """A corridor along x with its axis at y = 0; the robot begins near its end, a little off the axis."""
    length, width = CORRIDOR
    cells = np.ones((round(width / _CELL) + 4, round(length / _CELL) + 4), bool)
    cells[2:-2, 2:-2] = False
    start = 0.8, float(random.uniform(-0.1, 0.1)), float(random.uniform(-0.15, 0.15))
    return _world(cells, (-2 * _CELL, -width / 2.0 - 2 * _CELL), (), (), start)


def _world(
    cells: np.ndarray[tuple[int, ...], np.dtype[np.bool_]],
    corner: tuple[float, float],
    boxes: tuple[Box, ...],
    obstacles: tuple[Box, ...],
    start: tuple[float, float, float],
) -> WorldModel:
    file = MapFile(
        Path("room.png"), _CELL, (*corner, 0.0), negate=False, occupied_thresh=0.65, free_thresh=0.25, mode="trinary"
    )
    plan = MapImage(file, np.where(cells, 100, 0).astype(np.int8))
    return WorldModel(plan, 1.0, 0.9, boxes, obstacles, start)
