"""Corners of fiducials to a few hundredths of a pixel, without the bias that OpenCV's own refinement has.

OpenCV traces the outermost dark pixels, so that a square comes out a third of a pixel too small on each side, and so
1 % too far away at 40 pixels: enough to stretch a whole map. Here each edge is a line through the places where the
brightness changes across it, and a corner is where two such lines meet.
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from ur_nodes.geometry.rigid import Floats

_STEP = 0.25  # pixels between samples across an edge
_REACH = 3.0  # pixels to either side of it at most, and at most nine tenths of a cell
_CELLS = 7.0  # along an edge of the usual dictionaries
_LEAST_CHANGE = 30.0  # of brightness, for an edge to count there
_LEAST_POINTS = 4
_FURTHEST = 3.0  # pixels that a corner may move


def refine_corners(grey: npt.NDArray[np.uint8], corners: Floats) -> Floats:
    """Refine the corners (4, 2) of a dark square on light ground; unchanged where its edges are not clear."""
    centre = corners.mean(axis=0)
    lines = [_fit_edge(grey, corners[k], corners[(k + 1) % 4], centre) for k in range(4)]
    refined: Floats = corners.copy()
    for k in range(4):
        before, after = lines[k - 1], lines[k]
        if before is None or after is None:
            return corners
        met = _meet(*before, *after)
        if met is not None and np.linalg.norm(met - corners[k]) < _FURTHEST:
            refined[k] = met
    return refined


def _fit_edge(grey: npt.NDArray[np.uint8], begin: Floats, end: Floats, centre: Floats) -> tuple[Floats, Floats] | None:
    """Return a point and a direction (2,) of the line through the brightness steps between two corners."""
    length = float(np.linalg.norm(end - begin))
    if length < 4.0:
        return None
    along = (end - begin) / length
    outward = np.array([along[1], -along[0]])
    outward = outward if outward @ (begin - centre) > 0.0 else -outward
    reach = min(_REACH, 0.9 * length / _CELLS)
    offsets = np.arange(-reach, reach + _STEP / 2.0, _STEP)
    places = begin + np.linspace(0.12, 0.88, max(6, int(length)))[:, None] * (end - begin)
    samples = (places[:, None, :] + offsets[None, :, None] * outward).astype(np.float32)
    values = cv2.remap(grey, samples[..., 0], samples[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    rises = np.clip(np.diff(np.asarray(values, np.float64), axis=1), 0.0, None)
    total = rises.sum(axis=1)
    clear = total > _LEAST_CHANGE
    if clear.sum() < _LEAST_POINTS:
        return None
    shift = (rises[clear] @ (offsets[:-1] + _STEP / 2.0)) / total[clear]
    points = places[clear] + shift[:, None] * outward
    middle = points.mean(axis=0)
    return middle, np.linalg.svd(points - middle)[2][0]


def _meet(a: Floats, along_a: Floats, b: Floats, along_b: Floats) -> Floats | None:
    """Return the intersection of two lines; None when they are nearly parallel."""
    matrix = np.stack([along_a, -along_b], axis=1)
    if abs(np.linalg.det(matrix)) < 0.1:
        return None
    met: Floats = a + np.linalg.solve(matrix, b - a)[0] * along_a
    return met
