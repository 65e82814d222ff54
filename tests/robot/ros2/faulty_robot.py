"""A robot on ROS 2 whose nodes do not fit together: `base` or `laptop`, the half of it that this process is."""

from __future__ import annotations

import sys

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.executors import ExternalShutdownException
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import BatteryState, LaserScan

LOOSE = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)


def main(half: str) -> None:
    rclpy.init(args=sys.argv)
    node = rclpy.create_node(half, parameter_overrides=[Parameter("use_sim_time", value=half == "laptop")])
    if half == "base":
        node.create_subscription(TwistStamped, "cmd_vel", lambda _message: None, 10)
        battery = node.create_publisher(BatteryState, "battery", 10)
        scans = node.create_publisher(LaserScan, "scan", LOOSE)

        def send() -> None:
            battery.publish(BatteryState(percentage=0.05))
            message = LaserScan()
            message.header.stamp = node.get_clock().now().to_msg()
            scans.publish(message)

        node.create_timer(0.1, send)
    else:
        node.create_publisher(Twist, "cmd_vel", 10)
        node.create_subscription(LaserScan, "scan", lambda _message: None, 10)
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        node.destroy_node()


if __name__ == "__main__":
    main(sys.argv[1])
