"""Log and simulated time of a node of ROS 2."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from ur_nodes.ports.log import ThrottledLog

if TYPE_CHECKING:
    from rclpy.clock import JumpHandle
    from rclpy.node import Clock, Logger


def make_log(logger: Logger, read: Callable[[], float]) -> ThrottledLog:
    """Make the log of a node."""
    return ThrottledLog(logger.debug, logger.info, logger.warning, logger.error, read)


def follow_clock(clock: Clock, call: Callable[[], None]) -> JumpHandle:
    """Call a function, on the spinning thread, when a clock has a new time, as long as the result is kept."""
    from rclpy.clock import JumpThreshold
    from rclpy.duration import Duration

    every = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))
    return clock.create_jump_callback(every, post_callback=lambda _jump: call())
