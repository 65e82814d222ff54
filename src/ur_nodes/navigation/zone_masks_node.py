"""Masks of keep-out zones and speed zones, from the topics that a map server or a filter mask server publishes."""

from __future__ import annotations

from typing import Any

import rospy

from ur.source.diagnostic import UserError
from ur_nodes.geometry.grid import Grid
from ur_nodes.rosio.grid_message import GridMessage, grid_of_message


class ZoneMasks:
    """The newest masks in the map frame: `keep_out` is 100 in zones, `speed` a percentage; None before the first."""

    def __init__(self, keep_out_topic: str, speed_topic: str) -> None:
        """An empty topic: there are no such zones."""
        self.keep_out: Grid | None = None
        self.speed: Grid | None = None
        self._changed = False
        if keep_out_topic:
            rospy.Subscriber(keep_out_topic, GridMessage, self._take_keep_out, queue_size=1)
        if speed_topic:
            rospy.Subscriber(speed_topic, GridMessage, self._take_speed, queue_size=1)

    def take_change(self) -> bool:
        """Return whether the keep-out zones have changed since the last call."""
        changed, self._changed = self._changed, False
        return changed

    def _take_keep_out(self, message: Any) -> None:
        grid = _read(message)
        if grid is not None:
            self.keep_out, self._changed = grid, True

    def _take_speed(self, message: Any) -> None:
        grid = _read(message)
        if grid is not None:
            self.speed = grid


def _read(message: Any) -> Grid | None:
    try:
        return grid_of_message(message)
    except UserError as problem:
        rospy.logerr("zones are not changed: %s", problem)
        return None
