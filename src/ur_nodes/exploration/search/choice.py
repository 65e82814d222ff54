"""The next place to drive to: the first of the shortest tour through the places that frontiers are seen from."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.exploration.search.floor import Floor, drive_distances
from ur_nodes.exploration.search.viewpoints import Viewpoint

_MOST = 9  # places of a tour: the nearest ones
_COARSE = 0.2  # m, side of the cells that ways between places are measured on


@dataclass(frozen=True, slots=True)
class Weights:
    """`distance` weighs a metre of the way, `gain` a square metre behind a frontier: potential and gain scale.

    `keep` (m) is the advantage of the place that the robot is driving to.
    """

    distance: float = 1.0
    gain: float = 0.1
    keep: float = 0.5


def choose_viewpoint(
    floor: Floor, viewpoints: Sequence[Viewpoint], weights: Weights, kept: tuple[float, float] | None = None
) -> Viewpoint | None:
    """Choose the place to drive to first; None when there is none. `kept`: the frontier that is pursued, m."""
    near = sorted(viewpoints, key=lambda each: each.distance)[:_MOST]
    if len(near) < 2:
        return near[0] if near else None
    between = _distances_between(floor, near)
    onward = _shortest_onward(between)
    scores = []
    for index, each in enumerate(near):
        score = weights.distance * (each.distance + onward[index]) - weights.gain * each.frontier.gain
        if kept is not None and np.hypot(each.frontier.point[0] - kept[0], each.frontier.point[1] - kept[1]) < 1.0:
            score -= weights.keep
        scores.append(score)
    return near[int(np.argmin(scores))]


def _distances_between(floor: Floor, viewpoints: Sequence[Viewpoint]) -> NDArray[np.float64]:
    """Ways (n, n) in m between the places, on coarse cells; the straight distance where those do not connect."""
    factor = max(1, round(_COARSE / floor.resolution))
    height, width = (-(-side // factor) for side in floor.shape)
    padded = np.zeros((height * factor, width * factor), bool)
    padded[: floor.shape[0], : floor.shape[1]] = floor.reachable
    coarse = np.asarray(padded.reshape(height, factor, width, factor).any(axis=(1, 3)))
    cells = [(each.cell[0] // factor, each.cell[1] // factor) for each in viewpoints]
    ways = np.zeros((len(cells), len(cells)))
    for index, cell in enumerate(cells):
        costs = drive_distances(coarse, cell, floor.resolution * factor)
        ways[index] = [costs[other] for other in cells]
    return ways


def _shortest_onward(between: NDArray[np.float64]) -> NDArray[np.float64]:
    """From each place (n): the length of the shortest path through all others, after Held and Karp."""
    count = len(between)
    whole = (1 << count) - 1
    # best[visited][last]: the shortest path that begins at `last` and goes through all that are not in `visited`.
    best = np.zeros((whole + 1, count))
    for visited in range(whole - 1, 0, -1):
        left = [index for index in range(count) if not visited >> index & 1]
        options = np.array([between[:, index] + best[visited | 1 << index, index] for index in left])
        best[visited] = options.min(axis=0)
    return np.array([best[1 << index, index] for index in range(count)])
