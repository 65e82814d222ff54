"""The next place to drive to: the first of the shortest tour of viewpoints; corners, which hide little, come last."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.exploration.search.floor import Floor, drive_distances
from ur_nodes.exploration.search.viewpoints import Viewpoint

_SAME = 1.0  # m: a frontier so near to the pursued one is the same, after the map has changed
_PURSUED = 0.5  # of the limit: what is pursued becomes a corner later, so that the robot does not turn back and forth
_SOON = 3.0  # m: after a way so long without news what is pursued becomes no corner at all
_BESIDE = 0.5  # m: of two corners that are nearer, that which hides less is left out first
_PASSED = 1.0  # m: nearer corners that will be visited are visited before the rooms


@dataclass(frozen=True, slots=True)
class CornerSettings:
    """A frontier with less than `area` m2 behind it is a corner. A doorway of 0.75 m or more has more.

    `left_out`: corners may be left out that hide so much of the known floor together, as a share; 0: none is.
    """

    area: float = 0.5
    left_out: float = 0.017


@dataclass(frozen=True, slots=True)
class Viewpoints:
    """Viewpoints by what they can show: `now`, those that are chosen from; `later`, after these; and `left_out`."""

    now: tuple[Viewpoint, ...]
    later: tuple[Viewpoint, ...] = ()
    left_out: tuple[Viewpoint, ...] = ()

    @property
    def ahead(self) -> tuple[Viewpoint, ...]:
        """Return all viewpoints that will be visited."""
        return self.now + self.later


def sort_corners(
    viewpoints: Sequence[Viewpoint],
    known: float,
    settings: CornerSettings,
    kept: tuple[float, float] | None = None,
    idle_distance: float = 0.0,
) -> Viewpoints:
    """Sort viewpoints on a map with `known` m2 of floor; `kept` (m) is the frontier that the robot drives to.

    `idle_distance` (m): how far it has driven since the map last grew.

    `now` is empty if no viewpoint is worth its distance. Corners that hide the least for the way to them are left out
    first; what several of them hide is counted once.
    """

    def is_corner(each: Viewpoint) -> bool:
        pursued = kept is not None and math.dist(each.frontier.point, kept) < _SAME
        limit = 0.0 if idle_distance > _SOON else _PURSUED * settings.area
        return each.frontier.gain < (limit if pursued else settings.area)

    rooms = tuple(each for each in viewpoints if not is_corner(each))
    corners = sorted(filter(is_corner, viewpoints), key=lambda each: each.frontier.gain / (_BESIDE + each.distance))
    left_out: list[Viewpoint] = []
    hidden, counted = 0.0, set[int]()
    for each in corners:
        behind = each.frontier.hidden
        hidden += each.frontier.gain * (len(behind - counted) / len(behind) if behind else 1.0)
        counted |= behind
        if hidden > settings.left_out * known:
            break
        left_out.append(each)
    visited = corners[len(left_out) :]
    soon = _PASSED if rooms else math.inf
    near = tuple(each for each in visited if each.distance < soon)
    return Viewpoints(rooms + near, tuple(each for each in visited if each.distance >= soon), tuple(left_out))


_MOST = 9  # places of a tour: the nearest ones
_COARSE = 0.2  # m, side of the cells that ways between places are measured on


@dataclass(frozen=True, slots=True)
class Weights:
    """`distance` weighs a metre of the way, `gain` a square metre behind a frontier: potential and gain scale.

    `first` weighs the way to the first place against that through the others, which what is found on it will change.
    `keep` (m) is the advantage of the place that the robot is driving to.
    """

    distance: float = 1.0
    first: float = 1.5
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
    # From each place (n): the length of the shortest path through all others, after Held and Karp
    count = len(between)
    whole = (1 << count) - 1
    # best[visited][last]: the shortest path that begins at `last` and goes through all that are not in `visited`.
    best = np.zeros((whole + 1, count))
    for visited in range(whole - 1, 0, -1):
        left = [index for index in range(count) if not visited >> index & 1]
        options = np.array([between[:, index] + best[visited | 1 << index, index] for index in left])
        best[visited] = options.min(axis=0)
    onward = np.array([best[1 << index, index] for index in range(count)])
    scores = []
    for index, each in enumerate(near):
        score = weights.distance * (weights.first * each.distance + onward[index]) - weights.gain * each.frontier.gain
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
    lengths = np.zeros((len(cells), len(cells)))
    for index, cell in enumerate(cells):
        costs = drive_distances(coarse, cell, floor.resolution * factor)
        lengths[index] = [costs[other] for other in cells]
    return lengths
