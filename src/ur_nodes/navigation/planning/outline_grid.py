"""Blocked headings of a robot's outline: for each cell, those of 64 at which it touches obstacles, as bits."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.costmap import FREE, LETHAL, Costmap
from ur_nodes.costmap.footprint import Footprint

HEADINGS = 64
"""Headings in a turn, evenly apart from 0 on."""

STEP = math.tau / HEADINGS
"""Angle between two of them, rad."""

Floats = NDArray[np.float64]


def heading_number(yaw: float) -> int:
    """The nearest heading's number."""
    return round(yaw / STEP) % HEADINGS


def heading_angle(number: int) -> float:
    """The angle of a heading, rad, in (-pi, pi]."""
    return (number if number <= HEADINGS // 2 else number - HEADINGS) * STEP


@dataclass(frozen=True, slots=True, eq=False)
class OutlineStamp:
    """The cells that an outline covers, in cells from that of its origin: offsets (n, 2), and headings as bits (n).

    Made for one resolution and one angle between the axes of grid and frame.
    """

    offsets: NDArray[np.intp]
    bits: NDArray[np.uint64]


def make_stamp(footprint: Footprint, resolution: float, turned: float, room: float = 0.0) -> OutlineStamp:
    """The stamp for grids whose x axis is `turned` (rad) in their frame; with `room` (m) round the outline."""
    found: dict[tuple[int, int], int] = {}
    samples = footprint.samples
    if room > 0.0:
        lengths = np.maximum(np.hypot(*footprint.outline.T), 1e-9)[:, None]
        corners = footprint.outline * (1.0 + room * math.sqrt(2.0) / lengths)
        nexts = np.roll(corners, -1, axis=0)
        shares = np.linspace(0.0, 1.0, 2 + math.ceil(2.0 * footprint.circumscribed / resolution), endpoint=False)
        edges = (corners[:, None] + shares[None, :, None] * (nexts - corners)[:, None]).reshape(-1, 2)
        samples = np.concatenate((samples, edges))
    for number in range(HEADINGS):
        angle = number * STEP - turned
        c, s = math.cos(angle), math.sin(angle)
        columns = np.floor((c * samples[:, 0] - s * samples[:, 1]) / resolution + 0.5).astype(int)
        rows = np.floor((s * samples[:, 0] + c * samples[:, 1]) / resolution + 0.5).astype(int)
        for cell in set(zip(rows.tolist(), columns.tolist(), strict=True)):
            found[cell] = found.get(cell, 0) | 1 << number
    return OutlineStamp(np.array(list(found), np.intp).reshape(-1, 2), np.array(list(found.values()), np.uint64))


def blocked_headings(lethal: NDArray[np.bool_], stamp: OutlineStamp) -> NDArray[np.uint64]:
    """For each cell (height, width) the headings as bits at which the outline covers a lethal cell.

    What lies beyond the grid counts as free.
    """
    height, width = lethal.shape
    rows, columns = np.nonzero(lethal)
    blocked = np.zeros(height * width, np.uint64)
    for (down, right), bits in zip(stamp.offsets.tolist(), stamp.bits, strict=True):
        r, c = rows - down, columns - right
        inside = (r >= 0) & (r < height) & (c >= 0) & (c < width)
        blocked[r[inside] * width + c[inside]] |= bits  # each cell once: the lethal ones are different cells
    return blocked.reshape(height, width)


def overlaps(poses: Floats, costmap: Costmap, footprint: Footprint) -> NDArray[np.intp]:
    """Count the samples of the footprint that lie on obstacles at each pose (..., 3). Beyond the costmap is free."""
    c, s = np.cos(poses[..., 2, None]), np.sin(poses[..., 2, None])
    fx, fy = footprint.samples.T
    points = np.stack((poses[..., 0, None] + c * fx - s * fy, poses[..., 1, None] + s * fx + c * fy), axis=-1)
    counts: NDArray[np.intp] = (costmap.costs_at(points, outside=FREE) == LETHAL).sum(axis=-1)
    return counts
