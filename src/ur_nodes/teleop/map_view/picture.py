"""The part of a map on a screen, and map, path, scan and robot as its pixels. Pure: arrays in, arrays out.

A pixel is half a terminal cell: cells are about twice as high as wide.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ur.tui.screen.half_blocks import Colour, Pixels
from ur_nodes.client.snapshot import RobotSnapshot
from ur_nodes.geometry.grid import Grid
from ur_nodes.teleop.map_view.palette import MapPalette

ROBOT_LENGTH = 0.45
"""The diameter of the robot in m when it is large enough to be drawn to scale."""

_OCCUPIED = 50
_ONE_PIXEL = 1.5  # pixels: a wall that is thinner is drawn as one pixel, wherever it lies between two
SMALL_ROBOT = 6.0
"""Pixels below which the robot is one arrow character."""
_AROUND = 1.04  # the picture by the map, when all of the map is shown
_FINEST, _COARSEST = 0.005, 5.0  # m per pixel


@dataclass(frozen=True, slots=True)
class Viewport:
    """The map point in the middle, m per pixel, and the size in pixels. Rows go down, y goes up."""

    x: float
    y: float
    scale: float
    width: int
    height: int

    def to_map(self, column: float, row: float) -> tuple[float, float]:
        """Return the map point at a position on the screen, in pixels from the top left corner."""
        return self.x + (column - self.width / 2) * self.scale, self.y - (row - self.height / 2) * self.scale

    def to_pixel(self, x: float, y: float) -> tuple[float, float]:
        """Return column and row in pixels of a map point, which may be off the screen."""
        return (x - self.x) / self.scale + self.width / 2, (self.y - y) / self.scale + self.height / 2


def fit_viewport(bounds: tuple[float, float, float, float], width: int, height: int) -> Viewport:
    """Return the viewport that just contains a box (left, bottom, right, top in m)."""
    left, bottom, right, top = bounds
    scale = max((right - left) / max(width, 1), (top - bottom) / max(height, 1)) * _AROUND
    return Viewport((left + right) / 2, (bottom + top) / 2, _clamp(scale), width, height)


def zoom_viewport(view: Viewport, factor: float, column: float | None = None, row: float | None = None) -> Viewport:
    """Return the view magnified by `factor` about a pixel (default: the middle), which stays in its place."""
    column = view.width / 2 if column is None else column
    row = view.height / 2 if row is None else row
    x, y = view.to_map(column, row)
    scale = _clamp(view.scale / factor)
    return replace(view, scale=scale, x=x - (column - view.width / 2) * scale, y=y + (row - view.height / 2) * scale)


def pan_viewport(view: Viewport, columns: float, rows: float) -> Viewport:
    """Move the view right and down by a number of pixels."""
    return replace(view, x=view.x + columns * view.scale, y=view.y - rows * view.scale)


def resize_viewport(view: Viewport, width: int, height: int) -> Viewport:
    """Return the same middle and scale on a screen of another size."""
    return replace(view, width=width, height=height)


def _clamp(scale: float) -> float:
    return min(max(scale, _FINEST), _COARSEST)


@dataclass(frozen=True, eq=False)
class GridIndex:
    """A grid with running sums, so that the share of walls in any box of cells takes four look-ups."""

    grid: Grid
    walls: NDArray[np.int32]  # (height + 1, width + 1): occupied cells below and left
    known: NDArray[np.int32]


def index_grid(grid: Grid) -> GridIndex:
    """Prepare a grid for drawing; once per map."""
    return GridIndex(grid, _running_sum(grid.values >= _OCCUPIED), _running_sum(grid.values >= 0))


def draw_map(index: GridIndex | None, view: Viewport, palette: MapPalette) -> Pixels:
    """Draw the map without robot: (view.height, view.width, 3). Each wall is visible, in one colour.

    A thin wall is one pixel wide, whether it lies within a pixel or on the edge of two.
    """
    picture = np.empty((view.height, view.width, 3), dtype=np.uint8)
    picture[:] = palette.unknown
    if index is None or not picture.size:
        return picture
    grid = index.grid
    xs, ys = np.meshgrid(
        view.x + (np.arange(view.width) + 0.5 - view.width / 2) * view.scale,
        view.y - (np.arange(view.height) + 0.5 - view.height / 2) * view.scale,
    )
    rows, columns = np.moveaxis(grid.fractions_of_points(np.stack((xs, ys), axis=-1)), -1, 0)
    # Boxes along the grid's axes; on a turned map they overlap, so that they leave no cell out.
    half = view.scale / grid.resolution / 2 * (abs(math.cos(grid.origin.yaw)) + abs(math.sin(grid.origin.yaw)))
    height, width = grid.values.shape
    left, right = _span(columns, half, width)
    bottom, top = _span(rows, half, height)
    area = np.maximum((right - left) * (top - bottom), 1)
    walls = _box_sum(index.walls, left, right, bottom, top) / area
    known = _box_sum(index.known, left, right, bottom, top) / area
    picture[known >= 0.5] = palette.free
    picture[thin_walls(walls) if half > 0.5 else walls > 0.0] = palette.wall
    return picture


def draw_overlay(picture: Pixels, snapshot: RobotSnapshot, view: Viewport, palette: MapPalette) -> Pixels:
    """Return a copy of the picture with path, scan and, if it is large enough to be drawn, the robot."""
    out: Pixels = picture.copy()
    if snapshot.path is not None and len(snapshot.path) > 1:
        _dot(out, _along(snapshot.path, view.scale * 0.7), view, palette.path)
    if snapshot.scan is not None and len(snapshot.scan):
        _dot(out, snapshot.scan, view, palette.scan)
    if snapshot.pose is not None and ROBOT_LENGTH / view.scale >= SMALL_ROBOT:
        # Draw a disc at the pose, with a stripe from its middle to its front
        pose = snapshot.pose
        size = ROBOT_LENGTH / view.scale
        column, row = view.to_pixel(pose.x, pose.y)
        ys, xs = np.mgrid[0 : view.height, 0 : view.width]
        dx, dy = xs + 0.5 - column, row - (ys + 0.5)
        c, s = math.cos(pose.yaw), math.sin(pose.yaw)
        along, aside = c * dx + s * dy, np.abs(c * dy - s * dx)
        disc = along**2 + aside**2 <= (size / 2) ** 2
        out[disc] = palette.robot
        out[disc & (along >= 0.0) & (aside <= max(0.6, size * 0.08))] = palette.ink
    return out


def thin_walls(share: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return the pixels that show a wall; of two pixels that share a thin wall, the one with more of it.

    A pixel is left out only at a straight edge, beside three that hold at least as much: gaps cannot arise.
    """
    left = share.copy()
    for turns in range(4):  # from above, from the right, from below, from the left
        seen = np.rot90(np.pad(left, 3), turns)
        beyond, own, other, behind = (_sides(seen[row : row + seen.shape[0] - 5]) for row in (1, 2, 3, 4))
        backed = np.all(own < other if turns < 2 else own <= other, axis=0, where=own > 0.0)
        width = beyond[1] + own[1] + other[1] + behind[1]
        free = (beyond == 0.0).all(axis=0)
        end = (own[0] == 0.0) & (own[2] == 0.0)
        dropped = (own[1] > 0.0) & ~end & free & backed & ((own[1] < 0.5) | (width < _ONE_PIXEL))
        seen[2:-3, 1:-1][dropped] = 0.0
        left = np.rot90(seen, -turns)[3:-3, 3:-3]
    kept: NDArray[np.bool_] = left > 0.0
    return kept


def _sides(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return each pixel's left neighbour, itself and its right neighbour, (3, rows, columns - 2)."""
    return np.stack((rows[:, :-2], rows[:, 1:-1], rows[:, 2:]))


def _running_sum(mask: NDArray[np.bool_]) -> NDArray[np.int32]:
    total = np.zeros((mask.shape[0] + 1, mask.shape[1] + 1), dtype=np.int32)
    total[1:, 1:] = mask.cumsum(axis=0, dtype=np.int32).cumsum(axis=1, dtype=np.int32)
    return total


def _span(centre: NDArray[np.float64], half: float, size: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return first and last + 1 cell of each pixel, at least one, clipped to the grid (empty outside); they tile it."""
    first = np.floor(centre - half + 0.5).astype(np.intp) if half > 0.5 else np.floor(centre).astype(np.intp)
    end = np.maximum(np.floor(centre + half + 0.5).astype(np.intp), first + 1) if half > 0.5 else first + 1
    return np.clip(first, 0, size), np.clip(end, 0, size)


def _box_sum(
    total: NDArray[np.int32],
    left: NDArray[np.intp],
    right: NDArray[np.intp],
    bottom: NDArray[np.intp],
    top: NDArray[np.intp],
) -> NDArray[np.int32]:
    return total[top, right] - total[bottom, right] - total[top, left] + total[bottom, left]


def _along(path: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Return points on a path, at most `step` apart."""
    lengths = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    at = np.arange(0.0, lengths[-1] + step, step)
    return np.stack((np.interp(at, lengths, path[:, 0]), np.interp(at, lengths, path[:, 1])), axis=1)


def _dot(out: Pixels, points: NDArray[np.float64], view: Viewport, colour: Colour) -> None:
    columns, rows = view.to_pixel(0.0, 0.0)
    px = np.floor(points[:, 0] / view.scale + columns)
    py = np.floor(rows - points[:, 1] / view.scale)
    inside = (px >= 0) & (px < view.width) & (py >= 0) & (py < view.height)
    out[py[inside].astype(np.intp), px[inside].astype(np.intp)] = colour
