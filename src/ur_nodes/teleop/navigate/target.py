"""The pose that a command asks for."""

from __future__ import annotations

from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.navigate.commands import Go, GoTo
from ur_nodes.teleop.navigator.model import Snapshot, heading_there
from ur_nodes.teleop.navigator.waypoints import WaypointStore


def target_of(command: Go | GoTo, snapshot: Snapshot, store: WaypointStore) -> Pose2:
    """The goal of a command on the map; without a heading, the one in which the robot arrives.

    Raises UserError: no such waypoint.
    """
    if isinstance(command, GoTo):
        return store.find(command.name)
    yaw = heading_there(snapshot, command.x, command.y) if command.yaw is None else command.yaw
    return Pose2(command.x, command.y, yaw)
