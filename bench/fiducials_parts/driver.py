"""Drives a simulated robot by its true pose, and keeps what it believes beside that."""

from __future__ import annotations

import math
import time
from typing import Any

import rospy
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Int32

from ur_nodes.codecs.genpy.fiducials import message_classes


class Driver:
    """Drives along corners by the true pose, and keeps what the robot believes beside it."""

    def __init__(self) -> None:
        self.true: tuple[float, float, float] | None = None
        self.odometry = (0.0, 0.0)
        self.pictures = 0
        self.offs: list[tuple[float, float]] = []
        self.collisions: int | None = None
        self._buffer: Any = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)
        self._velocity: Any = rospy.Publisher("/key_vel", Twist, queue_size=1)
        rospy.Subscriber("/base_pose_ground_truth", Odometry, self._take, queue_size=1)
        rospy.Subscriber("/simulator/collisions", Int32, self._take_collisions, queue_size=1)
        rospy.Subscriber("/odom", Odometry, self._take_odometry, queue_size=1)
        rospy.Subscriber("/fiducial_vertices", message_classes("FiducialArray")[0], self._count, queue_size=10)

    def _count(self, _message: Any) -> None:
        self.pictures += 1

    def _take_odometry(self, message: Any) -> None:
        self.odometry = (message.pose.pose.position.x, message.pose.pose.position.y)

    def _take_collisions(self, message: Any) -> None:
        self.collisions = message.data

    def _take(self, message: Any) -> None:
        place = message.pose.pose
        yaw = 2.0 * math.atan2(place.orientation.z, place.orientation.w)
        self.true = (place.position.x, place.position.y, yaw)
        try:
            found = self._buffer.lookup_transform_core("map", "base_footprint", message.header.stamp).transform
        except Exception:  # tf2 raises several kinds; not known yet
            return
        off = math.hypot(found.translation.x - place.position.x, found.translation.y - place.position.y)
        turn = 2.0 * math.atan2(found.rotation.z, found.rotation.w) - yaw
        self.offs.append((off, abs(math.remainder(turn, 2.0 * math.pi))))

    def follow(self, corners: list[tuple[float, float]], speed: float) -> None:
        """Drive from corner to corner: turn towards the next one, then go."""
        for x, y in corners:
            deadline = time.monotonic() + 90.0
            while time.monotonic() < deadline:
                if self.true is not None:
                    dx, dy = x - self.true[0], y - self.true[1]
                    if math.hypot(dx, dy) < 0.15:
                        break
                    turn = math.remainder(math.atan2(dy, dx) - self.true[2], 2.0 * math.pi)
                    command = Twist()
                    command.angular.z = max(-0.8, min(0.8, 2.0 * turn))
                    command.linear.x = speed * max(0.0, 1.0 - abs(turn) / 0.4)
                    self._velocity.publish(command)
                time.sleep(0.05)
            else:
                raise SystemExit(f"error: the robot did not reach {x}, {y} within 90 s: it is at {self.true}")
        rospy.sleep(0.5)
