"""The topics of an exploration: its status, its frontiers, and the goal and path of navigation."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from std_msgs.msg import String
from visualization_msgs.msg import Marker, MarkerArray

from ur_nodes.client.model import GoalReport, GoalState, Snapshot
from ur_nodes.exploration.status import Status, read_status
from ur_nodes.rosio.geometry import pose_of_message
from ur_nodes.teleop.explore.explore_screen import FRONTIER, GIVEN_UP
from ur_nodes.teleop.map_view.glyphs import Mark

_MOST_MARKS = 1000


class StatusTopic:
    """Subscribes to `status`."""

    def __init__(self) -> None:
        self.newest = Status()
        """The newest status."""
        rospy.Subscriber("status", String, self._take, queue_size=1)

    def _take(self, message: String) -> None:
        status = read_status(message.data)
        if status is not None:
            self.newest = status


class ExplorationTopics:
    """Subscribes to `frontiers`, `plan` and `current_goal`, for the picture of the map."""

    def __init__(self) -> None:
        self._goal = GoalReport()
        self._path: Any = None
        self._marks: tuple[Mark, ...] = ()
        rospy.Subscriber("frontiers", MarkerArray, self._take_frontiers, queue_size=1)
        rospy.Subscriber("plan", Path, self._take_path, queue_size=1)
        rospy.Subscriber("current_goal", PoseStamped, self._take_goal, queue_size=1)

    def add(self, snapshot: Snapshot) -> Snapshot:
        """The snapshot with goal and path."""
        return replace(snapshot, goal=self._goal, path=self._path)

    def marks(self) -> tuple[Mark, ...]:
        """The middle of each frontier."""
        return self._marks

    def _take_frontiers(self, message: MarkerArray) -> None:
        shown = [m for m in message.markers if m.action == Marker.ADD and m.points][:_MOST_MARKS]
        self._marks = tuple(_mark_of(marker) for marker in shown)

    def _take_path(self, message: Path) -> None:
        points = [(stamped.pose.position.x, stamped.pose.position.y) for stamped in message.poses]
        self._path = np.array(points, dtype=np.float64).reshape(-1, 2)

    def _take_goal(self, message: PoseStamped) -> None:
        self._goal = GoalReport(self._goal.number + 1, pose_of_message(message.pose), GoalState.DRIVING)


def _mark_of(marker: Marker) -> Mark:
    """A frontier as a character at the one of its points that is nearest to their mean."""
    points = np.array([(point.x, point.y) for point in marker.points])
    x, y = points[int(np.argmin(np.sum((points - points.mean(axis=0)) ** 2, axis=1)))].tolist()
    blocked = marker.color.r > marker.color.b
    return Mark(x, y, GIVEN_UP if blocked else FRONTIER, blocked)
