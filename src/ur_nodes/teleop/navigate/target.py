"""The poses that a command asks for."""

from __future__ import annotations

from ur_nodes.client.model import Snapshot, heading_there
from ur_nodes.client.patrol_text import Route, Stop
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.navigate.commands import AskPatrol, Go, GoTo


def target_of(command: Go | GoTo, snapshot: Snapshot, store: WaypointStore) -> tuple[Pose2, bool]:
    """The goal of a command on the map, and whether any heading counts there.

    Raises UserError: no such waypoint.
    """
    if isinstance(command, GoTo):
        return store.find(command.name), False
    yaw = heading_there(snapshot.pose, command.x, command.y) if command.yaw is None else command.yaw
    return Pose2(command.x, command.y, yaw), command.yaw is None


def route_of(command: AskPatrol, store: WaypointStore) -> Route:
    """The route of a patrol. Raises UserError: no such waypoint."""
    return Route(tuple(Stop(name, *store.find(name)) for name in command.names), command.loop, command.wait)
