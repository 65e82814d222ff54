"""A `Navigator` over ROS: map, scan, tf, plans, and the action move_base."""

from __future__ import annotations

import itertools
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
from std_srvs.srv import Empty

from ur.source.diagnostic import UserError, error
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS
from ur_nodes.motion.lease.client_node import LeaseClient
from ur_nodes.motion.lease.view import LeaseView
from ur_nodes.navigation.goal_claim import write_goal_id
from ur_nodes.rosio.geometry import pose_message, pose_of_message
from ur_nodes.rosio.grid_message import grid_of_message
from ur_nodes.teleop.mux.driver_text import DriverRequest, describe_silence
from ur_nodes.teleop.mux.emergency import MuxRequest
from ur_nodes.teleop.mux.link_node import MuxLink
from ur_nodes.teleop.navigator.goal_tracker import (
    Status,
    Tracker,
    read_hold,
    report_at,
    track_current,
    track_hold,
    track_result,
    track_sent,
    track_status,
)
from ur_nodes.teleop.navigator.model import ROBOT, Silence, Snapshot
from ur_nodes.teleop.navigator.robot_state_node import RobotState

_STATUS_SILENT = 3.0
_SILENT = 1.0  # s without a message, after which a sender counts as silent
_NANO = 1_000_000_000
# What amcl takes as spread of a pose that a person points at: RViz's "2D Pose Estimate" sends the same.
_POINTED_VARIANCE = (0.25, 0.25, (math.pi / 12) ** 2)


@dataclass(frozen=True, slots=True)
class Names:
    """Frames, the topic of the global path, the node that is the mux; everything else is remapped as usual."""

    map_frame: str = "map"
    base_frame: str = "base_footprint"
    plan_topic: str = "move_base/NavfnROS/plan"
    mux: str = "cmd_vel_mux"


class RosNavigator:
    """See `Navigator`. The node is registered before one is made; what has not come yet is in `Snapshot.missing`."""

    def __init__(self, names: Names) -> None:
        self._names = names
        self._lock = threading.Lock()
        self._seen = Snapshot()
        self._tracker = Tracker()
        self._status_at = -math.inf
        self._numbers = itertools.count(1)
        self._mux = MuxLink(names.mux)
        self._lease = LeaseClient(names.mux, "keyboard_navigate")
        self._lease_topic = rospy.resolve_name(f"{names.mux}/lease")
        self._leased = any(topic == self._lease_topic for topic, _ in rospy.get_published_topics())
        self._robot = RobotState(names.map_frame, names.base_frame)
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

    def snapshot(self) -> Snapshot:
        """Return the newest state."""
        now, mux, lease = time.monotonic(), self._mux.view(), self._lease.view()
        pose, scan, (speed, turn) = self._robot.pose(), self._robot.scan(), self._robot.velocity(now)
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
                missing=self._missing(pose, now, leased=lease.state != "unknown", mux=mux.stopped is not None),
                mux=mux,
                lease=lease,
                conduct=self._lease.conduct,
                silence=self._silence(lease, now),
            )

    def go(self, place: Pose2) -> int:
        """See `Navigator`. The goal's id names the client that sends it and answers the mux's newest challenge."""
        goal_id = self._make_goal_id()
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

    def _make_goal_id(self) -> str:
        start = f"{rospy.get_name()}-{next(self._numbers)}-{time.time():.3f}"
        view = self._lease.view()
        if view.state == "unknown":
            return start  # a mux without leases, as upstream's
        answer = self._lease.link.answer(REQUEST_FRESHNESS / 2.0)
        if answer is None:
            raise UserError(error(describe_silence(ROBOT, view.link_age), rule="no-word"))
        if not view.mine:
            self._lease.acquire()
        return write_goal_id(start, self._lease.client, answer.secs * _NANO + answer.nsecs)

    def resume(self) -> None:
        """Let the goal that is held go on, if this arrives in time."""
        with self._lock:
            goal_id = self._tracker.hold.goal_id
        answer = self._lease.link.answer(REQUEST_FRESHNESS / 2.0)
        if answer is not None:
            self._continues.publish(GoalID(id=goal_id, stamp=answer))

    def request_lease(self, request: DriverRequest) -> None:
        """Ask to drive, or let another drive."""
        {"take": self._lease.take, "ask": self._lease.ask, "grant": self._lease.grant}[request]()

    def close(self) -> None:
        """Release the lease."""
        self._lease.release()

    def stop(self) -> None:
        """Cancel the goal, whoever sent it."""
        self._cancels.publish(GoalID())  # an empty one cancels all: actionlib's protocol

    def ask_mux(self, request: MuxRequest) -> None:
        """Stop everything that drives, or release the emergency stop."""
        self._mux.ask(request)

    def set_pose(self, place: Pose2) -> None:
        """Set the estimated pose of the robot."""
        message = PoseWithCovarianceStamped()
        message.header.stamp, message.header.frame_id = rospy.Time.now(), self._names.map_frame
        message.pose.pose = pose_message(place)
        covariance = [0.0] * 36
        covariance[0], covariance[7], covariance[35] = _POINTED_VARIANCE
        message.pose.covariance = covariance
        self._poses.publish(message)

    def relocalise(self) -> None:
        """Search for the robot on the whole map. Raises UserError when the localiser does not offer that."""
        try:
            rospy.ServiceProxy("global_localization", Empty)()
        except (rospy.ServiceException, rospy.ROSException) as problem:
            name = rospy.resolve_name("global_localization")
            raise UserError(
                error(f"service {name}: {problem}, expected a localiser that offers it", rule="no-service")
            ) from None

    def _silence(self, lease: LeaseView, now: float) -> Silence | None:
        """Return the sender that was received before and is silent now: the robot when mux and navigation both are."""
        heard = [] if lease.state == "unknown" else [("the mux", lease.link_age)]
        if self._status_at > -math.inf:
            heard.append(("navigation", now - self._status_at))
        silent = [Silence(*each) for each in heard if each[1] > _SILENT]
        if not silent:
            return None
        if len(silent) == len(heard):
            return Silence(ROBOT, min(each.seconds for each in silent))
        return silent[0]

    def _missing(self, pose: Pose2 | None, now: float, *, leased: bool, mux: bool) -> tuple[str, ...]:
        """List what a goal needs and is missing. A mux of ours has to publish its lease before the first goal."""
        names = self._names
        missing = []
        if self._seen.grid is None:
            missing.append(f"the map (topic {rospy.resolve_name('map')})")
        if pose is None:
            missing.append(f"the robot's pose (tf {names.map_frame} -> {names.base_frame})")
        elif self._robot.silent(now):
            missing.append(f"an update of the robot's pose (tf {names.map_frame} -> {names.base_frame} is silent)")
        if not self._goals.get_num_connections() or now - self._status_at > _STATUS_SILENT:
            missing.append(f"navigation (action {rospy.resolve_name('move_base')})")
        if not leased and (mux or self._leased):
            missing.append(f"the lease of the mux (topic {self._lease_topic})")
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
        statuses = tuple(Status(item.goal_id.id, item.status, item.text) for item in message.status_list)
        with self._lock:
            self._status_at = time.monotonic()
            self._tracker = track_status(self._tracker, statuses, self._status_at)

    def _on_hold(self, message: Any) -> None:
        hold = read_hold(message.data)
        if hold is not None:
            with self._lock:
                self._tracker = track_hold(self._tracker, hold)

    def _on_result(self, message: Any) -> None:
        status = Status(message.status.goal_id.id, message.status.status, message.status.text)
        with self._lock:
            self._tracker = track_result(self._tracker, status, time.monotonic())
