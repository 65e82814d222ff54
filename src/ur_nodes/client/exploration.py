"""The topics of an exploration: its status, its frontiers, and the goal and path of navigation."""

from dataclasses import dataclass, replace

import numpy as np

from ur_nodes.client.snapshot import GoalReport, LastGoalState, RobotSnapshot
from ur_nodes.exploration.status import ExploreStatus, read_status
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Marker, Markers, Path, StampedPose

_MOST_FRONTIERS = 1000


@dataclass(frozen=True, slots=True)
class FrontierPoint:
    """A point of a frontier in the map, m; `blocked`: it was given up."""

    x: float
    y: float
    blocked: bool


class ExplorationStatus:
    """The status of an exploration. Reads may come from any thread."""

    def __init__(self, node: Node, topic: str = "status") -> None:
        self.newest = ExploreStatus()
        """The newest status; that of an exploration that has ended stays."""
        self._received = False
        self._statuses = node.subscribe(topic, str, self._on_text, Quality.LATCHED)

    def shown(self) -> ExploreStatus | None:
        """Return the newest status; None without an exploration."""
        there = self._received and (self.newest.ended or self._statuses.publishers())
        return self.newest if there else None

    def _on_text(self, text: str) -> None:
        status = read_status(text)
        if status is not None:
            self.newest, self._received = status, True


class ExplorationTopics:
    """Frontiers, plan and goal of an exploration, for the picture of the map. Reads may come from any thread."""

    def __init__(self, node: Node) -> None:
        self.frontiers: tuple[FrontierPoint, ...] = ()
        self._seen = RobotSnapshot()
        node.subscribe("frontiers", Markers, self._on_frontiers, Quality.LATCHED)
        node.subscribe("plan", Path, self._on_path)
        node.subscribe("current_goal", StampedPose, self._on_goal, Quality.LATCHED)

    def add(self, snapshot: RobotSnapshot) -> RobotSnapshot:
        """Return the snapshot with goal and path."""
        return replace(snapshot, goal=self._seen.goal, path=self._seen.path)

    def _on_frontiers(self, markers: Markers) -> None:
        shown = [each for each in markers.markers if len(each.points)][:_MOST_FRONTIERS]
        self.frontiers = tuple(_frontier_of(each) for each in shown)

    def _on_path(self, path: Path) -> None:
        self._seen = replace(self._seen, path=path.poses[:, :2])

    def _on_goal(self, goal: StampedPose) -> None:
        report = GoalReport(self._seen.goal.number + 1, goal.pose, LastGoalState.DRIVING)
        self._seen = replace(self._seen, goal=report)


def _frontier_of(marker: Marker) -> FrontierPoint:
    """The point of a frontier that is nearest to the mean of all."""
    points = marker.points[:, :2]
    x, y = points[int(np.argmin(np.sum((points - points.mean(axis=0)) ** 2, axis=1)))].tolist()
    return FrontierPoint(x, y, blocked=marker.colour[0] > marker.colour[2])
