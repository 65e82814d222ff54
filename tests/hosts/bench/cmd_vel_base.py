"""A base on ROS 2 that does what it is commanded, for ever: it holds its last velocity, as many do.

`--stamped` takes TwistStamped. It publishes odometry and scans, and writes `TIME SPEED` (monotonic s, m/s) of each
command and `TIME` of each step into /run/base/log.
"""

from __future__ import annotations

import math
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
    stamped = "--stamped" in sys.argv
    rclpy.init(args=[each for each in sys.argv if each != "--stamped"])
    node = rclpy.create_node("base")
    odometry = node.create_publisher(Odometry, "odom", 10)
    scans = node.create_publisher(LaserScan, "scan", QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT))
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
        message = Odometry(child_frame_id="base_link")
        message.header.frame_id = "odom"
        message.header.stamp = node.get_clock().now().to_msg()
        message.pose.pose.position.x, message.pose.pose.position.y = pose[0], pose[1]
        message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(pose[2] / 2), math.cos(pose[2] / 2)
        message.twist.twist = command
        odometry.publish(message)

    def scan() -> None:
        message = LaserScan(angle_min=-3.14, angle_max=3.14, angle_increment=0.0174, range_min=0.1, range_max=8.0)
        message.header.frame_id = "base_link"  # Jazzy's wheels have no messages of transforms
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


if __name__ == "__main__":
    main()
