"""The motors of a base: motors twist|stamped LANE NOTES. They note what arrives, reliably, as drivers do."""

from __future__ import annotations

import os
import struct
import sys
import time
from typing import Any

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.executors import ExternalShutdownException

_RECORD = struct.Struct("=ddd")  # of `recorder.read_outputs`


def main(kind: str, lane: str, notes: str) -> None:
    """Run until it is ended."""
    file = os.open(notes, os.O_WRONLY | os.O_CREAT | os.O_APPEND)

    def take(message: Any) -> None:
        twist = message.twist if kind == "stamped" else message
        os.write(file, _RECORD.pack(time.monotonic(), twist.linear.x, twist.angular.z))

    rclpy.init()
    node = rclpy.create_node("motors", namespace=lane)
    node.create_subscription(TwistStamped if kind == "stamped" else Twist, "base_vel", take, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        return


if __name__ == "__main__":
    main(*sys.argv[1:4])
