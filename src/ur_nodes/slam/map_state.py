"""A map at one moment, as it is drawn and stored: keyframes, edges, scans, and the path of the robot along them."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.matching.surface import Floats


class Edge(NamedTuple):
    """The pose of keyframe `after` in the frame of `before`, with a covariance (3, 3); robust: unless contradicted."""

    before: int
    after: int
    relative: Pose2
    covariance: Floats
    robust: bool


def find_drives(edges: Sequence[Edge], count: int) -> list[int]:
    """Return the numbers of the keyframes at which a later drive begins: only robust edges lead to them."""
    tied = {edge.after for edge in edges if not edge.robust}
    return [number for number in range(1, count) if number not in tied]


_APART = (0.3, 0.6)  # m, rad: nearer ones show the same


def select_views(poses: Floats, candidates: Iterable[int], most: int | None = None) -> list[int]:
    """Select keyframes of which no two show the same, at most `most`; earlier candidates win. `poses` are (n, 3)."""
    chosen: list[int] = []
    for number in candidates:
        if len(chosen) == most:
            break
        shift = np.hypot(*(poses[chosen, :2] - poses[number, :2]).T)
        turn = np.abs(wrap_angle(poses[chosen, 2] - poses[number, 2]))
        if not np.any((shift < _APART[0]) & (turn < _APART[1])):
            chosen.append(number)
    return chosen


class Trail:
    """Scans by their number, each with a keyframe and the pose relative to it; 32 bytes a scan."""

    def __init__(self) -> None:
        self._numbers = array("i")  # of scan and keyframe
        self._relative = array("d")

    def add(self, scan: int, keyframe: int, relative: Pose2) -> None:
        """Add the place of a scan; it replaces an earlier one of the same number."""
        self._numbers.extend((scan, keyframe))
        self._relative.extend(relative)

    def extend(self, other: Trail, first: int) -> None:
        """Add another trail, whose keyframes 0, 1, ... are numbered from `first` on here."""
        numbers = np.array(other._numbers, np.int32).reshape(-1, 2)
        numbers[:, 1] += first
        self._numbers.frombytes(numbers.tobytes())
        self._relative.extend(other._relative)

    def path(self, keyframes: Sequence[Pose2]) -> dict[int, Pose2]:
        """The poses of all scans by their number, ascending, as follow from the poses of the keyframes."""
        numbers = np.array(self._numbers, np.int32).reshape(-1, 2).tolist()
        relative = np.array(self._relative).reshape(-1, 3).tolist()
        found = {
            scan: keyframes[keyframe].compose(Pose2(*pose))
            for (scan, keyframe), pose in zip(numbers, relative, strict=True)
        }
        return dict(sorted(found.items()))


@dataclass(frozen=True, slots=True, eq=False)
class MapState:
    """Keyframes with their scans, and the edges between them.

    `drives` are the numbers of the keyframes with which a later drive begins.
    """

    poses: Sequence[Pose2]
    edges: Sequence[Edge]
    scans: Sequence[MapScan]
    drives: Sequence[int] = ()
