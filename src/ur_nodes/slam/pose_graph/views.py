"""Selection of keyframes with different views: of two taken near each other in the same direction, one is enough."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ur_nodes.geometry.pose import wrap_angle
from ur_nodes.slam.matching.surface import Floats

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
