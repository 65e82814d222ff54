"""The action of navigation and the messages of the mux, as the exploration uses them."""

from __future__ import annotations

import threading
import uuid
from dataclasses import replace
from typing import Any

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult
from std_msgs.msg import Bool, String
from std_srvs.srv import Empty

from ur_nodes.exploration.explorer_step import GoalEnd
from ur_nodes.exploration.pause import Drivers, note_time, reason_to_pause
from ur_nodes.exploration.settings_node import ExploreSettings
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.lease.text import read_lease
from ur_nodes.rosio.geometry import pose_message

_AT_WORK = (GoalStatus.PENDING, GoalStatus.ACTIVE, GoalStatus.PREEMPTING, GoalStatus.RECALLING)


class Navigation:
    """One goal at a time. May be used from any thread."""

    def __init__(self, settings: ExploreSettings) -> None:
        self._settings = settings
        self._lock = threading.Lock()
        self._drivers = Drivers()
        self._number = 0
        self._goal = ""
        self._end: GoalEnd | None = None
        self._alive = False
        self._start = f"{rospy.get_name()}-{uuid.uuid4().hex[:8]}-"  # of our goals' ids
        self._goals = rospy.Publisher(f"{settings.navigation}/goal", MoveBaseActionGoal, queue_size=1)
        self._cancels = rospy.Publisher(f"{settings.navigation}/cancel", GoalID, queue_size=1)
        self._clear = rospy.ServiceProxy(f"{settings.navigation}/clear_costmaps", Empty)
        rospy.Subscriber(f"{settings.mux}/stopped", Bool, self._take_stopped, queue_size=1)
        rospy.Subscriber(f"{settings.mux}/active", String, self._take_active, queue_size=1)
        rospy.Subscriber(f"{settings.mux}/lease", String, self._take_lease, queue_size=1)
        rospy.Subscriber(f"{settings.navigation}/status", GoalStatusArray, self._take_status, queue_size=1)
        rospy.Subscriber(f"{settings.navigation}/result", MoveBaseActionResult, self._take_result, queue_size=10)

    def ready(self) -> bool:
        """Return whether the action is there."""
        return self._alive and self._goals.get_num_connections() > 0 and self._cancels.get_num_connections() > 0

    def pause(self, now: float) -> str:
        """Return why the robot must not be driven now; '' when it may."""
        with self._lock:
            self._drivers = note_time(self._drivers, now)
            return reason_to_pause(self._drivers, now, self._settings.quiet)

    def send(self, goal: Pose2) -> None:
        """Drive to a pose, in place of the goal before."""
        stamp = rospy.Time.now()
        message = MoveBaseActionGoal()
        message.header.stamp = message.goal_id.stamp = message.goal.target_pose.header.stamp = stamp
        message.goal.target_pose.header.frame_id = self._settings.map_frame
        message.goal.target_pose.pose = pose_message(goal)
        with self._lock:
            self._number += 1
            self._goal = message.goal_id.id = f"{self._start}{self._number}"
            self._end = None
        self._goals.publish(message)

    def cancel(self) -> None:
        """Pursue nothing any more."""
        with self._lock:
            goal, self._goal, self._end = self._goal, "", None
        if goal:
            self._cancels.publish(GoalID(id=goal))

    def take_end(self) -> GoalEnd | None:
        """Return how the goal has ended, once."""
        with self._lock:
            end, self._end = self._end, None
            return end

    def clear(self) -> None:
        """Have the costmaps forget what sensors saw."""
        try:
            self._clear()
        except rospy.ServiceException as problem:
            rospy.logwarn("the costmaps are not cleared: %s", problem)

    def _take_result(self, message: Any) -> None:
        status = message.status
        with self._lock:
            if not self._goal or status.goal_id.id != self._goal:
                return
            self._goal = ""
            if status.status in (GoalStatus.PREEMPTED, GoalStatus.RECALLED):  # by somebody else: look who drives
                self._drivers = replace(self._drivers, driven=rospy.get_time())
                return
            self._end = GoalEnd(status.status == GoalStatus.SUCCEEDED, str(status.text))

    def _take_stopped(self, message: Bool) -> None:
        with self._lock:
            self._drivers = replace(self._drivers, stopped=bool(message.data))

    def _take_active(self, message: String) -> None:
        with self._lock:
            self._drivers = replace(self._drivers, active=str(message.data))

    def _take_lease(self, message: String) -> None:
        lease = read_lease(message.data)
        if lease is not None:
            with self._lock:
                self._drivers = replace(self._drivers, lease=lease)

    def _take_status(self, message: Any) -> None:
        at_work = (item.goal_id.id for item in message.status_list if item.status in _AT_WORK)
        foreign = any(not name.startswith(self._start) for name in at_work)
        with self._lock:
            self._alive = True
            self._drivers = replace(self._drivers, foreign=foreign)
