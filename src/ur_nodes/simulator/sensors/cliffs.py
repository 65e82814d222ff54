"""Cliff sensors: the floor below each of them, or a drop."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ur.robot.base import Cliffs
from ur.worlds.world_file import Drop
from ur_nodes.geometry.pose import Pose2


def see_drops(cliffs: Cliffs, drops: Sequence[Drop], pose: Pose2) -> dict[str, bool]:
    """Return by name which sensors of a robot at a pose in the map look at a drop."""
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    seen = {}
    for cliff in cliffs.at:
        along, left, _ = cliff.position
        x, y = pose.x + c * along - s * left, pose.y + s * along + c * left
        seen[cliff.name] = any(drop.holds(x, y) for drop in drops)
    return seen
