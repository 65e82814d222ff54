"""Publishes counted strings: best effort on /loose, and on topics whose publishers change once they are subscribed to.

/mixed gets a publisher that is best effort beside a reliable one, /changing one of another type in place of its own.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32, String

if TYPE_CHECKING:
    from rclpy.node import Publisher

_LOOSE = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
_WORD = "word"
_PERIOD = 0.05  # s


class Source:
    """See the module."""

    def __init__(self) -> None:
        self._node = rclpy.create_node("source")
        self._loose = self._node.create_publisher(String, "loose", _LOOSE)
        self._mixed = [self._node.create_publisher(String, "mixed", 10)]
        self._words = self._node.create_publisher(String, "changing", 10)
        self._numbers: list[Publisher] = []
        self._count = 0
        self._node.create_timer(_PERIOD, self._send)

    def _send(self) -> None:
        self._count += 1
        self._loose.publish(String(data=_WORD))
        for kind, publisher in zip(("reliable", "loose"), self._mixed, strict=False):
            publisher.publish(String(data=kind + _WORD))
        if self._numbers:
            self._numbers[0].publish(Int32(data=self._count))
        else:
            self._words.publish(String(data=_WORD))
        if self._count % 100 == 0:
            self._change()

    def _change(self) -> None:
        if len(self._mixed) == 1 and self._mixed[0].get_subscription_count():
            self._mixed.append(self._node.create_publisher(String, "mixed", _LOOSE))
        if not self._numbers and self._words.get_subscription_count():
            self._node.destroy_publisher(self._words)
            self._numbers.append(self._node.create_publisher(Int32, "changing", 10))

    def spin(self) -> None:
        """Publish until this process is ended."""
        try:
            rclpy.spin(self._node)
        except (KeyboardInterrupt, ExternalShutdownException):
            self._node.destroy_node()


if __name__ == "__main__":
    rclpy.init(args=sys.argv)
    Source().spin()
