"""Callbacks during the end of a node."""

import functools
from collections.abc import Callable
from typing import ParamSpec

import rospy

Parameters = ParamSpec("Parameters")


def _is_ending() -> bool:
    return bool(rospy.is_shutdown() or rospy.core.is_shutdown_requested())


def quiet_at_end(
    callback: Callable[Parameters, None], is_ending: Callable[[], bool] = _is_ending
) -> Callable[Parameters, None]:
    """Wrap a callback so that its errors are ignored while the node shuts down and its topics are closed."""

    @functools.wraps(callback)
    def call(*values: Parameters.args, **named: Parameters.kwargs) -> None:
        try:
            callback(*values, **named)
        except rospy.ROSException:
            if not is_ending():
                raise

    return call
