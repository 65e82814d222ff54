"""The tree of frames (tf) as plain values: the newest transform of each frame."""

from __future__ import annotations

import math

from ur_nodes.ports.values import Transform

_MOST = 400  # frames
_OLD = 30.0  # s after which a moving frame is left out


class FrameTree:
    """Frames by name. Times are seconds of any steady clock."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[float, list[object]]] = {}

    def take(self, transform: Transform, now: float, *, fixed: bool) -> None:
        """Take a transform unless it is malformed; a `fixed` one does not expire."""
        child, parent, pose = transform.child[:100], transform.parent[:100], transform.pose
        good = all(math.isfinite(each) and abs(each) < 1e6 for each in pose) and math.hypot(*pose.rotation) > 0.5
        if not child or child == parent or not good or (child not in self._known and len(self._known) >= _MOST):
            return
        self._known[child] = (math.inf if fixed else now), [child, parent, *(round(each, 5) for each in pose)]

    def describe(self, now: float) -> list[list[object]]:
        """Return rows of child, parent, x, y, z in m, and the quaternion x, y, z, w."""
        self._known = {name: each for name, each in self._known.items() if now - each[0] < _OLD}
        return [each for _, each in sorted(self._known.values(), key=lambda each: str(each[1][0]))]
