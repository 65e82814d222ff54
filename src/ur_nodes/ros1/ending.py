"""Callbacks that the end of a node overtakes."""

from __future__ import annotations

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
    """Return the same callback, silent when the node shuts down under it: its topics are closed by then."""

    @functools.wraps(callback)
    def call(*values: Parameters.args, **named: Parameters.kwargs) -> None:
        try:
            callback(*values, **named)
        except rospy.ROSException:
            if not is_ending():
                raise

    return call
