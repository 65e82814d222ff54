"""Occupancy grids as tiles on a fixed lattice of cells, so that a map that grows sends only the tiles that changed."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ur.web.wire.frames import TILE, GridFrame, Layer, grid_frame, tile_frame
from ur_nodes.geometry.grid import UNKNOWN, Grid
from ur_nodes.geometry.pose import Pose2

_SAME = 1e-3  # share of a cell by which an origin may be off the lattice
_FARTHEST = 100  # tiles from the lattice's origin

Index = tuple[int, int]


@dataclass(frozen=True, slots=True, eq=False)
class Tiles:
    """A grid that was sent: its lattice, and its tiles (TILE, TILE) with a known cell, by column and row."""

    frame: GridFrame | None = None
    tiles: dict[Index, NDArray[np.int8]] = field(default_factory=dict)


def cut_tiles(before: Tiles, grid: Grid) -> tuple[Tiles, tuple[Index, ...]]:
    """Cut a grid into tiles; return them and the indices of changed ones. A new lattice begins a generation."""
    offset = _offset_on(before.frame, grid)
    fresh = before.frame is None or offset is None
    generation = (before.frame.generation + 1 if before.frame else 1) if fresh else before.frame.generation  # type: ignore[union-attr]
    column, row = offset if offset is not None and not fresh else (0, 0)
    origin = tuple(grid.origin) if fresh or before.frame is None else before.frame.origin
    height, width = grid.shape
    frame = GridFrame(generation, grid.resolution, (origin[0], origin[1], origin[2]), column, row, width, height)
    old = {} if fresh else before.tiles
    tiles = _cut(grid.values, column, row)
    blank = np.full((TILE, TILE), UNKNOWN, np.int8)
    for index in old.keys() - tiles.keys():
        tiles[index] = blank
    changed = tuple(index for index, tile in tiles.items() if index not in old or not np.array_equal(old[index], tile))
    return Tiles(frame, tiles), changed


class GridFrames:
    """Makes the frames of a layer that is a grid, from the tiles that have changed since the last frames."""

    def __init__(self, layer: Layer) -> None:
        self._layer = layer
        self._tiles = Tiles()

    def show(self, grid: Grid) -> list[bytes]:
        """Return the frames that change what pages show into this grid."""
        self._tiles, changed = cut_tiles(self._tiles, grid)
        frame = self._tiles.frame
        assert frame is not None, "made from a grid"
        tiles = self._tiles.tiles
        return [
            grid_frame(self._layer, frame),
            *(tile_frame(self._layer, frame.generation, *index, tiles[index].tobytes()) for index in changed),
        ]

    def clear(self) -> list[bytes]:
        """Return the frames that clear the layer on the pages."""
        before = self._tiles.frame
        if before is None:
            return []
        empty = GridFrame(before.generation + 1, before.resolution, before.origin, 0, 0, 0, 0)
        self._tiles = Tiles(empty)
        return [grid_frame(self._layer, empty)]


def _cut(values: NDArray[np.int8], column: int, row: int) -> dict[Index, NDArray[np.int8]]:
    height, width = values.shape
    tiles = {}
    for y in range(row // TILE, (row + height - 1) // TILE + 1):
        for x in range(column // TILE, (column + width - 1) // TILE + 1):
            left, low = max(x * TILE, column), max(y * TILE, row)
            right, high = min((x + 1) * TILE, column + width), min((y + 1) * TILE, row + height)
            part = values[low - row : high - row, left - column : right - column]
            if (part != UNKNOWN).any():
                tile = np.full((TILE, TILE), UNKNOWN, np.int8)
                tile[low - y * TILE : high - y * TILE, left - x * TILE : right - x * TILE] = part
                tiles[x, y] = tile
    return tiles


def _offset_on(frame: GridFrame | None, grid: Grid) -> Index | None:
    """Return column and row of the grid's first cell on the lattice; None if the grid is not on it."""
    if frame is None or abs(frame.resolution - grid.resolution) > 1e-9 or abs(frame.origin[2] - grid.origin.yaw) > 1e-9:
        return None
    corner = Pose2(*frame.origin).inverse().compose(grid.origin)
    column, row = corner.x / grid.resolution, corner.y / grid.resolution
    if not (math.isfinite(column) and math.isfinite(row)):
        return None
    whole = round(column), round(row)
    if max(abs(column - whole[0]), abs(row - whole[1])) > _SAME or max(map(abs, whole)) > _FARTHEST * TILE:
        return None
    return whole
