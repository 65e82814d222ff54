"""The target poses of commands, and the file of waypoints."""

import os
from dataclasses import dataclass
from pathlib import Path

from ur.maps.names import waypoint_path
from ur_nodes.client.patrol_text import PatrolRoute, PatrolStop
from ur_nodes.client.saving import MapSaving
from ur_nodes.client.snapshot import RobotSnapshot, heading_there
from ur_nodes.client.waypoints import WaypointStore, name_of_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.teleop.navigate.commands import DrivePatrol, Go, GoToWaypoint

_SAVE_AGAIN = 2.0  # s until the name of a map that could not be saved is asked for again


@dataclass(frozen=True, slots=True)
class StoreChoice:
    """Chooses the file of waypoints: `file` if it is given, else that of the map, by its name or by its content.

    `growing` saves a map that is being made, whose content changes: its name is the one that it is saved under.
    """

    file: str = ""
    map_name: str = ""
    growing: MapSaving | None = None

    @property
    def title(self) -> str:
        """Return the name of the map for a screen."""
        return Path(self.map_name).stem

    def store_for(self, snapshot: RobotSnapshot) -> WaypointStore | None:
        """Return the waypoints once the map has arrived; None while it has no name."""
        if self.file:
            return WaypointStore(Path(self.file).expanduser())
        if self.map_name or self.growing:
            name = self.map_name or (self.growing.name if self.growing else "")
        else:
            assert snapshot.grid is not None, "asked for once the map has arrived"
            name = name_of_map(snapshot.grid)
        return WaypointStore(waypoint_path(name, os.environ)) if name else None


def name_growing_map(node: Node, service: str) -> MapSaving:
    """Save the map that is being made, again until it has a name."""
    saving = MapSaving(node, service, hint="")

    def ask() -> None:
        if saving.name:
            timer.cancel()
        else:
            saving.ask()

    timer = node.every(_SAVE_AGAIN, ask, steady=True)
    saving.ask()
    return saving


def target_of(command: Go | GoToWaypoint, snapshot: RobotSnapshot, store: WaypointStore) -> tuple[Pose2, bool]:
    """Return the goal of a command on the map, and whether any heading is accepted.

    Raises UserError: no such waypoint.
    """
    if isinstance(command, GoToWaypoint):
        return store.find(command.name), False
    yaw = heading_there(snapshot.pose, command.x, command.y) if command.yaw is None else command.yaw
    return Pose2(command.x, command.y, yaw), command.yaw is None


def route_of(command: DrivePatrol, store: WaypointStore) -> PatrolRoute:
    """Return the route of a patrol. Raises UserError for an unknown waypoint."""
    return PatrolRoute(tuple(PatrolStop(name, *store.find(name)) for name in command.names), command.loop, command.wait)
