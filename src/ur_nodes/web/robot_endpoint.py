"""The robot's end of the page: the robot's state for pages, and their requests."""

from collections.abc import Mapping
from typing import Any, Protocol

from ur_nodes.client.exploration import ExplorationStatus
from ur_nodes.client.mux import MuxLink
from ur_nodes.client.navigation import Names, NavigationTopics
from ur_nodes.client.patrol_text import PatrolLink
from ur_nodes.motion.challenge.freshness import Stamp
from ur_nodes.ports.node import Node
from ur_nodes.web.driving.driver_link import DriverLink
from ur_nodes.web.driving.driver_session import DrivenRobot, DriverSession
from ur_nodes.web.driving.page_goals import PageGoals
from ur_nodes.web.layers.pacing import FrameOutlet
from ur_nodes.web.maps.map_link import MapChanges, MapLink
from ur_nodes.web.maps.map_server_link import ZoneLink
from ur_nodes.web.maps.place_file import PlaceFile
from ur_nodes.web.view_state import RobotFacts
from ur_nodes.web.viewer_session import ShownRobot, ViewerSession


class LineOutlet(Protocol):
    """Sends JSON to the server without letting the node wait."""

    def send_line(self, value: Mapping[str, object]) -> None:
        """Send a line of JSON."""


class RobotSession:
    """Connects the robot to the server: sends frames through `view`, and answers to pages through `drive`."""

    def __init__(self, node: Node, view: FrameOutlet, drive: LineOutlet) -> None:
        names, facts, self._outlet = Names(), RobotFacts(node), drive
        topics, mux, patrol = NavigationTopics(node, names), MuxLink(node, names.mux), PatrolLink(node)
        places, zones, maps = PlaceFile(node), ZoneLink(node), MapLink(node)
        link = DriverLink(node, names.mux, facts.limits, self._on_challenge)
        changes = MapChanges(places, zones, maps, self._reply)
        robot = DrivenRobot(mux, PageGoals(node, topics, link, places.find), places, patrol, changes)
        self._drives = DriverSession(node, link, robot, self._reply)
        exploration = ExplorationStatus(node, "explore/status")
        shown = ShownRobot(facts, topics, mux, link, patrol, exploration, places, zones, maps)
        self._views = ViewerSession(node, names.mux, shown, view)

    def on_view(self, message: dict[str, Any]) -> None:
        """Take a message about what pages show."""
        layers, plots = message.get("layers", []), message.get("plots", [])
        self._views.look(int(message.get("viewers", 0)), layers, plots, message.get("camera", ""))

    def on_drive(self, message: dict[str, object]) -> None:
        """Take a message of a page that may drive."""
        page, drives = str(message.get("page", "")), self._drives
        match message.get("do"):
            case "come":
                name, computer = str(message.get("name", "")), str(message.get("computer", ""))
                drives.come(page, name, computer, once=message.get("once") is True)
            case "name":
                drives.rename(page, str(message.get("name", "")))
            case "leave":
                drives.remove(page)
            case "stop":
                drives.emergency()
            case _:
                drives.receive(page, str(message.get("m", "")))

    def _reply(self, page: str, answer: Mapping[str, object]) -> None:
        self._outlet.send_line({"page": page, "m": answer})

    def _on_challenge(self, challenge: Stamp) -> None:
        self._outlet.send_line({"n": challenge})
        self._drives.expire()
