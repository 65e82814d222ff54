"""The topics of navigation: map, scan, tf, plans and the action move_base, without a lease of its own."""

from __future__ import annotations

import math
import threading
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import rospy
from actionlib_msgs.msg import GoalID, GoalStatusArray
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult
from nav_msgs.msg import OccupancyGrid, Path
from rospy.numpy_msg import numpy_msg
from std_msgs.msg import String

from ur.source.diagnostic import UserError
from ur_nodes.client.goal_tracker import (
    Tracker,
    read_hold,
    report_at,
    track_current,
    track_hold,
    track_result,
    track_sent,
    track_status,
)
from ur_nodes.client.model import GoalReport, Snapshot
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ros1.goal_client import state_of
from ur_nodes.rosio.geometry import pose_message, pose_of_message
from ur_nodes.rosio.grid_message import grid_of_message
from ur_nodes.teleop.navigator.robot_state_node import RobotState

_STATUS_SILENT = 3.0
# What amcl takes as spread of a pose that a person points at: RViz's "2D Pose Estimate" sends the same.
_POINTED_VARIANCE = (0.25, 0.25, (math.pi / 12) ** 2)


@dataclass(frozen=True, slots=True)
class Names:
    """Frames, the topic of the global path, the node that is the mux; everything else is remapped as usual."""

    map_frame: str = "map"
    base_frame: str = "base_footprint"
    plan_topic: str = "move_base/NavfnROS/plan"
    mux: str = "cmd_vel_mux"


class NavigationTopics:
    """The topics and requests of navigation. The node is registered before one is made. No call blocks."""

    def __init__(self, names: Names) -> None:
        self._names = names
        self._lock = threading.Lock()
        self._seen = Snapshot()
        self._tracker = Tracker()
        self._status_at = -math.inf
        self.robot = RobotState(names.map_frame, names.base_frame)
        subscribe = rospy.Subscriber
        self._goals = rospy.Publisher("move_base/goal", MoveBaseActionGoal, queue_size=1)
        self._cancels = rospy.Publisher("move_base/cancel", GoalID, queue_size=1)
        self._continues = rospy.Publisher("move_base/continue", GoalID, queue_size=1)
        self._poses = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=1)
        subscribe("map", numpy_msg(OccupancyGrid), self._on_map, queue_size=1)
        subscribe("amcl_pose", PoseWithCovarianceStamped, self._on_amcl_pose, queue_size=1)
        subscribe(self._names.plan_topic, Path, self._on_plan, queue_size=1)
        subscribe("move_base/current_goal", PoseStamped, self._on_current_goal, queue_size=1)
        subscribe("move_base/status", GoalStatusArray, self._on_status, queue_size=1)
        subscribe("move_base/hold", String, self._on_hold, queue_size=1)
        subscribe("move_base/result", MoveBaseActionResult, self._on_result, queue_size=10)

    def snapshot(self, now: float) -> Snapshot:
        """The newest state, without mux, lease and silence; `now` is time.monotonic()."""
        pose, scan, (speed, turn) = self.robot.pose(), self.robot.scan(), self.robot.velocity(now)
        with self._lock:
            goal = report_at(self._tracker, now)
            return replace(
                self._seen,
                pose=pose,
                scan=scan,
                goal=goal,
                path=None if goal.over else self._seen.path,
                speed=speed,
                turn=turn,
                missing=self._missing(pose, now),
            )

    def goal(self, now: float) -> GoalReport:
        """The last goal; `now` is time.monotonic()."""
        with self._lock:
            return report_at(self._tracker, now)

    def status_age(self, now: float) -> float:
        """Seconds since navigation's last list of goals; infinite before the first."""
        return now - self._status_at

    def send_goal(self, goal_id: str, place: Pose2) -> int:
        """Send a goal with this id. Returns its number in `GoalReport`."""
        stamp = rospy.Time.now()
        message = MoveBaseActionGoal()
        message.header.stamp = message.goal_id.stamp = message.goal.target_pose.header.stamp = stamp
        message.goal_id.id = goal_id
        message.goal.target_pose.header.frame_id = self._names.map_frame
        message.goal.target_pose.pose = pose_message(place)
        with self._lock:
            self._tracker = track_sent(self._tracker, message.goal_id.id, place, time.monotonic())
            self._seen = replace(self._seen, path=None)
            number = self._tracker.report.number
        self._goals.publish(message)
        return number

    def continue_goal(self, answer: rospy.Time) -> None:
        """Let the goal that is held go on; `answer` is the challenge that this request answers."""
        with self._lock:
            goal_id = self._tracker.hold.goal_id
        self._continues.publish(GoalID(id=goal_id, stamp=answer))

    def cancel_goals(self) -> None:
        """Cancel the goal, whoever sent it."""
        self._cancels.publish(GoalID())  # an empty one cancels all: actionlib's protocol

    def set_pose(self, place: Pose2) -> None:
        """Set the estimated pose of the robot."""
        message = PoseWithCovarianceStamped()
        message.header.stamp, message.header.frame_id = rospy.Time.now(), self._names.map_frame
        message.pose.pose = pose_message(place)
        covariance = [0.0] * 36
        covariance[0], covariance[7], covariance[35] = _POINTED_VARIANCE
        message.pose.covariance = covariance
        self._poses.publish(message)

    def _missing(self, pose: Pose2 | None, now: float) -> tuple[str, ...]:
        """List what a goal needs and is missing."""
        names = self._names
        missing = []
        if self._seen.grid is None:
            missing.append(f"the map (topic {rospy.resolve_name('map')})")
        if pose is None:
            missing.append(f"the robot's pose (tf {names.map_frame} -> {names.base_frame})")
        elif self.robot.silent(now):
            missing.append(f"an update of the robot's pose (tf {names.map_frame} -> {names.base_frame} is silent)")
        if not self._goals.get_num_connections() or now - self._status_at > _STATUS_SILENT:
            missing.append(f"navigation (action {rospy.resolve_name('move_base')})")
        return tuple(missing)

    def _on_map(self, message: Any) -> None:
        try:
            grid = grid_of_message(message)
        except UserError as problem:
            rospy.logerr("%s", problem)
            return
        with self._lock:
            self._seen = replace(self._seen, grid=grid)

    def _on_amcl_pose(self, message: Any) -> None:
        covariance = message.pose.covariance
        with self._lock:
            self._seen = replace(self._seen, spread=math.sqrt(max(0.0, covariance[0] + covariance[7])))

    def _on_plan(self, message: Any) -> None:
        points = [(stamped.pose.position.x, stamped.pose.position.y) for stamped in message.poses]
        path = np.array(points, dtype=np.float64).reshape(-1, 2)
        with self._lock:
            self._seen = replace(self._seen, path=path)

    def _on_current_goal(self, message: Any) -> None:
        with self._lock:
            self._tracker = track_current(self._tracker, pose_of_message(message.pose), time.monotonic())

    def _on_status(self, message: Any) -> None:
        statuses = tuple(map(state_of, message.status_list))
        with self._lock:
            self._status_at = time.monotonic()
            self._tracker = track_status(self._tracker, statuses, self._status_at)

    def _on_hold(self, message: Any) -> None:
        hold = read_hold(message.data)
        if hold is not None:
            with self._lock:
                self._tracker = track_hold(self._tracker, hold)

    def _on_result(self, message: Any) -> None:
        with self._lock:
            self._tracker = track_result(self._tracker, state_of(message.status), time.monotonic())
