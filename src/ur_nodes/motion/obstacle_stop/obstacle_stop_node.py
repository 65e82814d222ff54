"""The obstacle stop over ROS: readings of the base's sensors in, what the mux may do and reports of it out."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import rospy
from nav_msgs.msg import Odometry
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan, Range
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, SetBoolRequest, SetBoolResponse

from ur.robot.base import Base
from ur_nodes.motion.obstacle_stop.base import contact_points, contact_topics, explain_frame, make_sight
from ur_nodes.motion.obstacle_stop.guard import Guard, Verdict, make_guard
from ur_nodes.motion.obstacle_stop.report import CLEAR, OFF, Report, report_of, write_report
from ur_nodes.motion.obstacle_stop.sight import Contact, Ranges, Sight, look, move, touch
from ur_nodes.motion.obstacle_stop.track import Odometer
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.geometry import pose_of_message

_CHOSEN = "~obstacle_stop_chosen"  # on the parameter server, so that the choice outlives this process
_EVERY = 0.2  # s between two reports of the same state
_WAITING = 64  # ranges: sonars of one base report together


class ObstacleStop:
    """Owns the sight of a base; calls `watch` with each new guard, None while it is off.

    `clock` reads the mux's time in s. Nothing is subscribed for a base without sensors that it can use.
    """

    def __init__(
        self,
        base: Base,
        clock: Callable[[], float],
        watch: Callable[[Guard | None], object],
        *,
        on: bool,
        sonars: bool,
        lag: float,
    ) -> None:
        """`on` is the choice at the start, `sonars`: the base has those of its file, `lag` (s) that of the mux."""
        self._base, self._clock, self._watch = base, clock, watch
        self._lock = threading.Lock()
        self._report_lock = threading.Lock()
        sight = make_sight(base, sonars=sonars)
        self._sensors = {sensor.name: sensor for sensor in sight.sensors}
        self._guard = make_guard(sight, base.limits, lag)
        self._usable = bool(sight.sensors or base.bumpers or base.cliffs)
        self._on = self._usable and rospy.get_param(_CHOSEN, on) is True
        self._warned = False
        self._reported = Report()
        self._reported_at = float("-inf")
        self._publisher = rospy.Publisher("~obstacle_stop", String, queue_size=1, latch=True)
        self._publish(CLEAR if self._on else OFF if self._usable else Report())
        if not self._usable:
            return
        self._watch(self._guard if self._on else None)
        rospy.Subscriber("odom", Odometry, self._on_odometry, queue_size=1, tcp_nodelay=True)
        if base.lidar:
            rospy.Subscriber(base.lidar.topic, numpy_msg(LaserScan), self._on_scan, queue_size=1, tcp_nodelay=True)
        if base.sonars and sonars:
            rospy.Subscriber(base.sonars.topic, Range, self._on_range, queue_size=_WAITING, tcp_nodelay=True)
        for contact, topic in contact_topics(base).items():
            rospy.Subscriber(topic, Bool, self._on_contact, contact, queue_size=1, tcp_nodelay=True)
        rospy.Service("~set_obstacle_stop", SetBool, self._on_choice)

    def note(self, verdict: Verdict | None, wanted: tuple[float, float], output: tuple[float, float]) -> None:
        """Publish the report of a verdict of the mux, for a wanted velocity and what was sent (m/s, rad/s)."""
        if not self._on:
            return
        report = report_of(verdict, wanted, output)
        now = self._clock()
        if report == self._reported or (report.state == self._reported.state and now - self._reported_at < _EVERY):
            return
        self._reported_at = now
        if report.state == "stopped" != self._reported.state:
            rospy.loginfo_throttle(5.0, report.text)
        self._publish(report)

    def _publish(self, report: Report) -> None:
        with self._report_lock:
            self._reported = report
            self._publisher.publish(write_report(report))

    def _on_choice(self, request: SetBoolRequest) -> SetBoolResponse:
        with self._lock:
            self._on = bool(request.data)
            self._watch(self._guard if self._on else None)
        rospy.set_param(_CHOSEN, self._on)
        self._publish(CLEAR if self._on else OFF)
        rospy.loginfo("the obstacle stop is %s", "on" if self._on else "off")
        return SetBoolResponse(success=True, message="on" if self._on else "off")

    def _change(self, step: Callable[[Sight], Sight]) -> None:
        with self._lock:
            guard = self._guard
            sight = step(guard.sight)
            if sight is guard.sight:
                return
            self._guard = Guard(sight, guard.braking, guard.lag)
            if self._on:
                self._watch(self._guard)

    def _time_of(self, message: Any) -> float:
        """The mux's time at which a message was measured, by its stamp; not later than now."""
        now, stamp = self._clock(), message.header.stamp
        return now if stamp.is_zero() else now - max(0.0, rospy.get_time() - stamp.to_sec())

    @quiet_at_end
    def _on_odometry(self, message: Odometry) -> None:
        twist = message.twist.twist
        pose = pose_of_message(message.pose.pose)
        reading = Odometer(pose, twist.linear.x, twist.angular.z, self._time_of(message))
        self._change(lambda sight: move(sight, reading))

    @quiet_at_end
    def _on_scan(self, message: LaserScan) -> None:
        sensor = self._sensors.get(self._base.lidar.topic) if self._base.lidar else None
        if sensor is None:
            return
        limits = message.range_min, message.range_max
        at, spacing = self._time_of(message), max(0.0, message.time_increment)
        angles = message.angle_min, message.angle_increment
        reading = Ranges(np.asarray(message.ranges), limits, at, *angles, spacing)
        self._change(lambda sight: look(sight, sensor, reading))

    @quiet_at_end
    def _on_range(self, message: Range) -> None:
        frame = message.header.frame_id.lstrip("/")
        sensor = self._sensors.get(frame)
        if sensor is None:
            self._warn_of_frame(frame)
            return
        limits = message.min_range, message.max_range
        reading = Ranges(np.array([message.range]), limits, self._time_of(message), cone=message.field_of_view)
        self._change(lambda sight: look(sight, sensor, reading))

    def _warn_of_frame(self, frame: str) -> None:
        if not self._warned and (reason := explain_frame(self._base, frame)):
            self._warned = True
            rospy.logwarn("%s", reason)

    @quiet_at_end
    def _on_contact(self, message: Bool, contact: tuple[Contact, str]) -> None:
        points = contact_points(self._base, self._guard.sight.hull, contact) if message.data else None
        self._change(lambda sight: touch(sight, contact, points))
