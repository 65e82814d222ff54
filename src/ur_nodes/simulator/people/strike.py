"""Contacts with people that a robot caused by its own motion."""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2

_PAUSE = 0.5  # s: a contact that comes back sooner is the same
_MOVING = 0.02  # m/s towards the person: slower robots were run into


class Strikes:
    """Counts contacts for each robot."""

    def __init__(self, robots: int) -> None:
        self._counts = [0] * robots
        self._last = [-math.inf] * robots

    @property
    def counts(self) -> tuple[int, ...]:
        """The number of contacts by robot."""
        return tuple(self._counts)

    def notice(
        self,
        robot: int,
        pose: Pose2,
        velocity: tuple[float, float, float],
        people: Iterable[NDArray[np.float64]],
        time: float,
    ) -> None:
        """Record the positions of people that a robot touches at a time (s); `velocity` is in the robot's frame."""
        forward, left, turn = velocity
        for place in people:
            x, y = pose.inverse().transform_points(place).tolist()
            distance = math.hypot(x, y)
            towards = (x * (forward - turn * y) + y * (left + turn * x)) / max(distance, 1e-6)
            if towards > _MOVING:
                if time - self._last[robot] > _PAUSE:
                    self._counts[robot] += 1
                self._last[robot] = time
