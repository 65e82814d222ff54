"""A base on ROS 2 that does what it is commanded, for ever: it holds its last velocity, as many do.

It publishes odometry and scans, and writes `TIME SPEED` (monotonic s, m/s) of each command and `TIME` of each step into
/run/base/log. `--stamped` takes TwistStamped. `--transforms FOLDER` publishes transforms; the modules of that folder
make their type where tf2_msgs are missing.
"""

from __future__ import annotations

import math
import struct
import sys
import time
from pathlib import Path

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan

LOG = Path("/run/base/log")
PERIOD = 0.05  # s


def main() -> None:
    words = sys.argv[:]
    folder = words.pop(words.index("--transforms") + 1) if "--transforms" in words else ""
    stamped = "--stamped" in words
    rclpy.init(args=[each for each in words if each not in ("--stamped", "--transforms")])
    node = rclpy.create_node("base")
    odometry = node.create_publisher(Odometry, "odom", 10)
    scans = node.create_publisher(LaserScan, "scan", QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT))
    transforms = node.create_publisher(type_of_transforms(folder), "/tf", 10) if folder else None
    pose = [0.0, 0.0, 0.0]
    command = Twist()
    log = LOG.open("a", buffering=1)

    def take_stamped(message: TwistStamped) -> None:
        take(message.twist)

    def take(message: Twist) -> None:
        nonlocal command
        command = message
        log.write(f"{time.monotonic():.4f} {command.linear.x:.4f} {command.angular.z:.4f}\n")

    def step() -> None:
        pose[0] += command.linear.x * math.cos(pose[2]) * PERIOD
        pose[1] += command.linear.x * math.sin(pose[2]) * PERIOD
        pose[2] += command.angular.z * PERIOD
        message = Odometry(child_frame_id="base_footprint")
        message.header.frame_id = "odom"
        message.header.stamp = node.get_clock().now().to_msg()
        message.pose.pose.position.x, message.pose.pose.position.y = pose[0], pose[1]
        message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(pose[2] / 2), math.cos(pose[2] / 2)
        message.twist.twist = command
        odometry.publish(message)
        if transforms is not None:
            stamp = message.header.stamp
            transforms.publish(bytes_of_transform(stamp.sec, stamp.nanosec, pose))

    def scan() -> None:
        message = LaserScan(angle_min=-3.14, angle_max=3.14, angle_increment=0.0174, range_min=0.1, range_max=8.0)
        message.header.frame_id = "base_footprint"
        message.header.stamp = node.get_clock().now().to_msg()
        message.ranges = [3.0] * 360
        scans.publish(message)

    if stamped:
        node.create_subscription(TwistStamped, "cmd_vel", take_stamped, 10)
    else:
        node.create_subscription(Twist, "cmd_vel", take, 10)
    node.create_timer(PERIOD, step)
    node.create_timer(0.1, scan)
    log.write("ready\n")
    rclpy.spin(node)


def type_of_transforms(folder: str) -> type:
    """The type of /tf, whose messages are bytes."""
    sys.path.insert(0, folder)
    from ur_nodes.codecs.bare import BareTransforms
    from ur_nodes.ros2.messages.bare_type import bare_class

    made: type = bare_class(*BareTransforms.BARE)
    return made


def bytes_of_transform(seconds: int, nanoseconds: int, pose: list[float]) -> bytes:
    """A tf2_msgs/TFMessage with odom -> base_footprint, in CDR. Numbers are aligned to their size."""
    data = struct.pack("<IiII5s3xI15s", 1, seconds, nanoseconds, 5, b"odom\0", 15, b"base_footprint\0")
    data += bytes(-len(data) % 8)
    data += struct.pack("<7d", pose[0], pose[1], 0.0, 0.0, 0.0, math.sin(pose[2] / 2), math.cos(pose[2] / 2))
    return b"\x00\x01\x00\x00" + data


if __name__ == "__main__":
    main()
