"""Points inside the walls that a scan has seen, for the cells of a map. Pure."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.matching.surface import Floats

_WINDOW = 4  # beams to either side whose ends are averaged
_REACH = 0.15  # m: as far as these may lie from the middle one
_STEP = 0.04  # m: ends farther off the surface belong to another one


def wall_points(scan: MapScan, depth: float) -> Floats:
    """Return a point (n, 2) in the wall for each hit of a scan, `depth` m behind its surface, in the robot's frame.

    With half a cell as the depth, the nearer edges of the cells that hold these points lie on the surface on average.
    The cells that hold the hits themselves would reach out of the wall, by half a cell on average towards the
    lidar. The noise along the normal is averaged over neighbours. Hits whose surface is not known stay as they are.
    """
    hits = scan.hits.astype(np.float64)
    if not len(hits):
        return hits
    nearest = np.arange(len(hits)) // -(-len(hits) // len(scan.facing))
    facing = scan.facing[nearest].astype(np.float64)
    normals = np.column_stack((np.cos(facing), np.sin(facing)))
    shift = np.where(scan.flat[nearest], _offsets(hits, normals) - depth, 0.0)
    moved: Floats = hits + normals * shift[:, None]
    return moved


def _offsets(hits: Floats, normals: Floats) -> NDArray[np.float64]:
    """The mean distance (n) of each hit's neighbours from it, along its normal."""
    places = np.arange(len(hits))[:, None] + np.arange(-_WINDOW, _WINDOW + 1)
    inside = (places >= 0) & (places < len(hits))
    delta = hits[np.clip(places, 0, len(hits) - 1)] - hits[:, None]
    along = (delta * normals[:, None]).sum(axis=2)
    counted = inside & (np.square(delta).sum(axis=2) <= _REACH * _REACH) & (np.abs(along) <= _STEP)
    offsets: NDArray[np.float64] = (along * counted).sum(axis=1) / counted.sum(axis=1)
    return offsets
