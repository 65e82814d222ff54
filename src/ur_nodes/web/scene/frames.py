"""The tree of frames (tf) as plain values: the newest transform of each frame."""

from __future__ import annotations

import math
from typing import Any

_MOST = 400  # frames
_OLD = 30.0  # s after which a moving frame is left out


class FrameTree:
    """Frames by name. Times are seconds of any steady clock."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[float, list[Any]]] = {}

    def take(self, transform: Any, now: float, *, fixed: bool) -> None:
        """Take a geometry_msgs/TransformStamped; one that is malformed is left out. `fixed`: it does not grow old."""
        child = str(transform.child_frame_id).lstrip("/")[:100]
        parent = str(transform.header.frame_id).lstrip("/")[:100]
        move, turn = transform.transform.translation, transform.transform.rotation
        numbers = [move.x, move.y, move.z, turn.x, turn.y, turn.z, turn.w]
        good = all(math.isfinite(each) and abs(each) < 1e6 for each in numbers) and math.hypot(*numbers[3:]) > 0.5
        if not child or child == parent or not good or (child not in self._known and len(self._known) >= _MOST):
            return
        self._known[child] = (math.inf if fixed else now), [child, parent, *(round(each, 5) for each in numbers)]

    def describe(self, now: float) -> list[list[Any]]:
        """Rows of child, parent, x, y, z in m, and the quaternion x, y, z, w."""
        self._known = {name: each for name, each in self._known.items() if now - each[0] < _OLD}
        return [each for _, each in sorted(self._known.values(), key=lambda each: str(each[1][0]))]
