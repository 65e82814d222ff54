"""Log and simulated time of a node of ROS 2."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from ur_nodes.ports.log import Throttle

if TYPE_CHECKING:
    from rclpy.clock import JumpHandle
    from rclpy.node import Clock, Logger


class RosLog:
    """See `ports.log.Log`."""

    def __init__(self, logger: Logger, read: Callable[[], float]) -> None:
        self._logger = logger
        self._throttle = Throttle(read)

    def debug(self, text: str) -> None:
        """See Log."""
        self._logger.debug(text)

    def info(self, text: str) -> None:
        """See Log."""
        self._logger.info(text)

    def warn(self, text: str, *, every: float = 0.0) -> None:
        """See Log."""
        if self._throttle.lets(text, every):
            self._logger.warning(text)

    def error(self, text: str, *, every: float = 0.0) -> None:
        """See Log."""
        if self._throttle.lets(text, every):
            self._logger.error(text)


def follow_clock(clock: Clock, call: Callable[[], None]) -> JumpHandle:
    """Have a call made, on the thread that spins, when a clock has a new time; while the result is kept."""
    from rclpy.clock import JumpThreshold
    from rclpy.duration import Duration

    every = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))
    return clock.create_jump_callback(every, post_callback=lambda _jump: call())
