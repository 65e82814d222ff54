"""The node between a driver and the rest: what the driver leaves out, under the names that the base file gives."""

from __future__ import annotations

import math
import sys
from typing import Any

import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Bool

from ur.robot.base import Base, Lidar, load_base
from ur.source.diagnostic import UserError, error
from ur.source.project import launch_library
from ur_nodes.drivers.base_states import BumperStates, WheelStates
from ur_nodes.geometry.pose import Pose3
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.publishers import TransformSender
from ur_nodes.rosio.shell import run_node

_LOOK_RATE = 10.0  # Hz
_WARN_EVERY = 10.0  # s
_QUATERNION_ERROR = 0.01
_BAD_ODOMETRY = (
    "odometry is left out, expected finite numbers, a unit quaternion and speeds that a robot can have:"
    " does the driver read its serial line at the right baud rate, without noise?"
)


class OdometryAdapter:
    """From `odom`: `joint_states`, and tf odom -> base_footprint when asked."""

    def __init__(self, base: Base, *, publish_tf: bool) -> None:
        self._wheels = WheelStates(base.wheels)
        self._joints = rospy.Publisher("joint_states", JointState, queue_size=10)
        self._message = JointState(name=["left_wheel_joint", "right_wheel_joint"])
        self._transforms = TransformSender() if publish_tf else None
        rospy.Subscriber("odom", Odometry, self._on_odometry, queue_size=10, tcp_nodelay=True)

    def _on_odometry(self, odometry: Odometry) -> None:
        stamp, twist = odometry.header.stamp, odometry.twist.twist
        if not _is_pose(odometry) or not self._wheels.update(twist.linear.x, twist.angular.z, stamp.to_sec()):
            rospy.logwarn_throttle(_WARN_EVERY, f"{rospy.resolve_name('odom')}: {_BAD_ODOMETRY}")
            return
        if self._transforms:
            place, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
            pose = Pose3(place.x, place.y, 0.0, turn.x, turn.y, turn.z, turn.w)
            self._transforms.send(stamp, ("odom", "base_footprint", pose))
        self._message.header.stamp = stamp
        self._message.position, self._message.velocity = self._wheels.angles, self._wheels.speeds
        self._joints.publish(self._message)


class ScanAdapter:
    """From `driver/scan`: the scan of the base's lidar, in its frame."""

    def __init__(self, lidar: Lidar) -> None:
        self._frame = lidar.frame
        self._scan = rospy.Publisher(lidar.topic, LaserScan, queue_size=5, tcp_nodelay=True)
        rospy.Subscriber("driver/scan", LaserScan, self._on_scan, queue_size=5, tcp_nodelay=True)

    def _on_scan(self, scan: LaserScan) -> None:
        scan.header.frame_id = self._frame
        self._scan.publish(scan)


class BumperAdapter:
    """From `driver/bumpers`, messages with `name` and `value`: a latched topic for each bumper of the base."""

    def __init__(self, topic: str, names: dict[str, str], known: list[str], kind: type[Any]) -> None:
        self._names = names
        self._states = BumperStates(known)
        self._topics = {name: rospy.Publisher(f"{topic}/{name}", Bool, queue_size=1, latch=True) for name in known}
        rospy.Subscriber("driver/bumpers", kind, self._on_bumper, queue_size=10)
        self._timer = rospy.Timer(rospy.Duration.from_sec(1.0 / _LOOK_RATE), self._publish_bumpers)

    def _on_bumper(self, message: Any) -> None:
        if message.value and message.name in self._names:
            self._states.press(self._names[message.name], rospy.get_time())
            self._publish_bumpers(None)

    def _publish_bumpers(self, _event: Any) -> None:
        for name, pressed in self._states.changes(rospy.get_time()).items():
            self._topics[name].publish(pressed)


def _is_pose(odometry: Odometry) -> bool:
    place, rotation = odometry.pose.pose.position, odometry.pose.pose.orientation
    length = math.hypot(rotation.x, rotation.y, rotation.z, rotation.w)
    return math.isfinite(place.x) and math.isfinite(place.y) and abs(length - 1.0) < _QUATERNION_ERROR


def start() -> None:
    """Read the parameters and connect. Raises UserError."""
    own = Parameters()
    base = load_base(own.text("package", str(launch_library())), own.text("base"), own.text("variant", ""))
    OdometryAdapter(base, publish_tf=own.boolean("publish_tf", False))
    if own.boolean("rename_scan", False) and base.lidar:
        ScanAdapter(base.lidar)
    kind = own.text("bumper_messages", "")
    if kind and base.bumpers:
        known = [bumper.name for bumper in base.bumpers.at]
        BumperAdapter(base.bumpers.topic, read_names(own, known), known, find_message(own, kind))


def read_names(own: Parameters, known: list[str]) -> dict[str, str]:
    """The parameter `bumper_names`: upstream's names and those of the base. Raises UserError."""
    names = rospy.get_param("~bumper_names", {})
    good = isinstance(names, dict) and all(isinstance(name, str) and name in known for name in names.values())
    if not good:
        own.fail("bumper_names", names, f"a map from upstream's names to some of {', '.join(known)}")
    return dict(names)


def find_message(own: Parameters, kind: str) -> type[Any]:
    """The class of a message type `package/Name`. Raises UserError where its package is not installed."""
    from roslib.message import get_message_class  # finds packages, which takes a moment

    found: type[Any] | None
    try:
        found = get_message_class(kind)
    except (ImportError, ValueError):
        found = None
    if found is None:
        own.fail("bumper_messages", kind, "a type of message as package/Name of an installed package")
        raise AssertionError
    if not {"name", "value"} <= set(getattr(found, "__slots__", ())):
        raise UserError(
            error(f"messages {kind} have no name and value, expected those of bumpers", rule="bad-parameter")
        )
    return found


if __name__ == "__main__":
    sys.exit(run_node("driver_adapter", start))
