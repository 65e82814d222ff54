"""Cliff sensors: the floor below each of them, or a drop."""

import math
from collections.abc import Sequence

from ur.robot.base import Cliffs
from ur.worlds.world_file import Drop
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.simulator.sensors.sense import Send, Sense, Site, open_switches


def see_drops(cliffs: Cliffs, drops: Sequence[Drop], pose: Pose2) -> dict[str, bool]:
    """Return by name which sensors of a robot at a pose in the map look at a drop."""
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    seen = {}
    for cliff in cliffs.at:
        along, left, _ = cliff.position
        x, y = pose.x + c * along - s * left, pose.y + s * along + c * left
        seen[cliff.name] = any(drop.holds(x, y) for drop in drops)
    return seen


class CliffSense(Sense):
    """The cliff sensors of one robot."""

    def __init__(self, cliffs: Cliffs, site: Site) -> None:
        self._cliffs, self._site = cliffs, site

    def seen(self) -> dict[str, bool]:
        """Return by name which of them see no floor."""
        return see_drops(self._cliffs, self._site.drops, self._site.physics.pose(self._site.robot))

    def advertise(self, node: Node, prefix: str, quality: Quality) -> Send:  # noqa: ARG002 - switches are latched
        """Open a topic for each."""
        topics = {each.name: f"{prefix}{self._cliffs.topic}/{each.name}" for each in self._cliffs.at}
        return open_switches(node, topics, lambda _: self.seen())


SENSE = CliffSense
