"""The obstacle layer: what the scan has seen, marked and cleared by tracing its rays."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.grid import CellFrame
from ur_nodes.geometry.pose import Pose2, Pose3, rotate
from ur_nodes.geometry.scan import RangeScan, angles_of_beams, classify_ranges

_SECTORS = 128  # of the full turn
_HALF = 0.72  # of a cell's side: no point of a cell is farther from its centre


@dataclass(frozen=True, slots=True)
class UsedRanges:
    """Used ranges of a scan, in m: obstacles nearer than `obstacle` are marked, rays clear up to `raytrace`."""

    obstacle: float
    raytrace: float


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """A scan as rays in its sensor's frame: `angles` (n) in rad, `ranges` (n) in m, `hits` (n): there is something.

    A ray without a hit is free up to its range. Rays without information (too near, not a number) are left out.
    """

    angles: NDArray[np.float64]
    ranges: NDArray[np.float64]
    hits: NDArray[np.bool_]

    def points(self) -> NDArray[np.float64]:
        """The points (n, 2) in the sensor's frame at which they end on something."""
        angles, ranges = self.angles[self.hits], self.ranges[self.hits]
        points = np.empty((len(angles), 2))
        points[:, 0], points[:, 1] = ranges * np.cos(angles), ranges * np.sin(angles)
        return points

    def ends(self, sensor: Pose2) -> NDArray[np.float64]:
        """The points (n, 2) at which they end on something, from a sensor at a pose."""
        return sensor.transform_points(self.points())


def level_beams(mount: Pose3, beams: Beams) -> tuple[Pose2, Beams]:
    """Return a sensor's planar pose and its beams as seen from above; a sensor upside down turns clockwise."""
    upright = rotate(mount.rotation, (0.0, 0.0, 1.0))[2] >= 0.0
    return mount.planar(), beams if upright else Beams(-beams.angles, beams.ranges, beams.hits)


def beams_of_scan(scan: RangeScan, *, inf_is_valid: bool) -> Beams:
    """Rays of a scan; +inf is free up to the greatest range if `inf_is_valid`.

    As in costmap_2d, a finite range at the upper limit or beyond is no reading.
    """
    ranges = np.asarray(scan.ranges, dtype=np.float64)
    hits = classify_ranges(ranges, (scan.range_min, scan.range_max)).hits
    keep = hits | (ranges == math.inf) if inf_is_valid else hits
    angles = angles_of_beams(len(ranges), scan.angle_min, scan.angle_increment)
    return Beams(angles[keep], np.where(hits, ranges, scan.range_max)[keep], hits[keep])


def trace_beams(
    occupied: NDArray[np.bool_],
    frame: CellFrame,
    sensor: Pose2,
    beams: Beams,
    reach: UsedRanges,
    *,
    behind: float = 0.0,
    ignore: Callable[[NDArray[np.intp]], NDArray[np.bool_]] | None = None,
) -> tuple[slice, slice] | None:
    """Clear the cells that rays pass through, then mark those they end in. Changes `occupied` (height, width).

    `frame` places the cells; `sensor` is the sensor's pose in its frame. Rays are sampled every 0.7 cells and stop
    half a cell before their end. What is marked is `behind` m beyond where a ray ends: with half a cell, a wall is as
    often marked too far as too near. Cells (n, 2) for which `ignore` is true (n) are not marked: they are known.
    Returns the box (rows, columns) of the cells that changed, or None.
    """
    width = frame.width
    bearing = beams.angles + sensor.yaw
    directions = np.cos(bearing), np.sin(bearing)
    flat = occupied.reshape(-1)
    cleared = np.empty(0, np.intp)
    if len(bearing):
        cleared = _find_passed(
            occupied,
            frame,
            sensor,
            directions,
            bearing,
            np.minimum(beams.ranges + behind - frame.resolution / 2, reach.raytrace),
        )
    near = beams.hits & (beams.ranges <= reach.obstacle)
    ranges = beams.ranges[near] + behind
    x, y = (start + ranges * each[near] for start, each in zip((sensor.x, sensor.y), directions, strict=True))
    cells = frame.cells_at(x, y)
    cells = cells[frame.contains(cells)]
    if ignore is not None:
        cells = cells[~ignore(cells)]
    marked = cells[:, 0] * width + cells[:, 1]
    new = marked[~flat[marked]]
    flat[cleared] = False
    flat[marked] = True
    changed = np.concatenate((cleared[~flat[cleared]], new))
    if not len(changed):
        return None
    rows, columns = changed // width, changed % width
    return slice(int(rows.min()), int(rows.max()) + 1), slice(int(columns.min()), int(columns.max()) + 1)


def _find_passed(
    occupied: NDArray[np.bool_],
    frame: CellFrame,
    sensor: Pose2,
    directions: tuple[NDArray[np.float64], NDArray[np.float64]],
    bearing: NDArray[np.float64],
    free: NDArray[np.float64],
) -> NDArray[np.intp]:
    """The numbers of the occupied cells (flat) that rays with `directions` (n), (n) pass on their first `free` (n) m.

    `occupied` is (height, width). Rays are sampled from where the nearest occupied cell of their sector begins.
    """
    height, width = frame.shape
    steps = np.arange(0.0, max(float(free.max()), frame.resolution), 0.7 * frame.resolution)
    nearest = _nearest_by_sector(occupied, frame, sensor, float(steps[-1]))
    if nearest is None:
        return np.empty(0, np.intp)
    begins = np.searchsorted(steps, nearest)[np.floor(bearing * (_SECTORS / math.tau)).astype(np.intp) % _SECTORS]
    counts = np.maximum(np.searchsorted(steps, free) - begins, 0)  # of the steps that are less than the free length
    ends = np.cumsum(counts)
    along = steps[np.arange(ends[-1]) + np.repeat(begins - (ends - counts), counts)]
    x, y = (np.repeat(each, counts) * along for each in directions)
    rows, columns = (np.floor(each, out=each) for each in frame.fractions_at(sensor.x + x, sensor.y + y))
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    cells = np.where(inside, rows * width + columns, 0.0).astype(np.intp)
    passed: NDArray[np.intp] = cells[occupied.reshape(-1)[cells] & inside]
    return passed


def _nearest_by_sector(
    occupied: NDArray[np.bool_], frame: CellFrame, sensor: Pose2, reach: float
) -> NDArray[np.float64] | None:
    """The least distance (m) from a sensor at which each of the sectors may hold a point of an occupied cell.

    inf where there is none within `reach` m or a little more; None: in no sector.
    """
    row, column = frame.fractions_of_points(np.array((sensor.x, sensor.y))).tolist()
    cells = reach / frame.resolution + 2.0
    top, left = (max(0, math.floor(each - cells)) for each in (row, column))
    rows, columns = occupied[top : max(0, math.ceil(row + cells)), left : max(0, math.ceil(column + cells))].nonzero()
    if not len(rows):
        return None
    across, along = rows + (top + 0.5 - row), columns + (left + 0.5 - column)  # from the sensor, in cells
    gaps = np.hypot(across, along)
    bearing = np.arctan2(across, along) + frame.origin[2]
    half = np.where(gaps > _HALF, np.arcsin(np.minimum(_HALF / np.maximum(gaps, _HALF), 1.0)), math.pi)
    low = np.floor((bearing - half) * (_SECTORS / math.tau)).astype(np.intp)
    counts = np.minimum(np.floor((bearing + half) * (_SECTORS / math.tau)).astype(np.intp) - low + 1, _SECTORS)
    ends = np.cumsum(counts)
    sectors = (np.arange(ends[-1]) + np.repeat(low - (ends - counts), counts)) % _SECTORS
    nearest = np.full(_SECTORS, np.inf)
    np.minimum.at(nearest, sectors, np.repeat((gaps - _HALF) * frame.resolution, counts))
    return nearest


def shift_cells(occupied: NDArray[np.bool_], rows: int, columns: int) -> NDArray[np.bool_]:
    """The cells of a window after it moved by whole cells; the cells that enter it are free."""
    height, width = occupied.shape
    moved = np.zeros_like(occupied)
    if abs(rows) < height and abs(columns) < width:
        source = occupied[max(0, rows) : height + min(0, rows), max(0, columns) : width + min(0, columns)]
        top, left = max(0, -rows), max(0, -columns)
        moved[top : top + source.shape[0], left : left + source.shape[1]] = source
    return moved
