"""The time of the node that publishes /clock: rospy would send it each stamp through a connection to itself."""

from __future__ import annotations

from collections.abc import Callable

import genpy
import rospy.impl.simtime
import rospy.rostime


def keep_own_clock() -> Callable[[genpy.Time], None]:
    """Stop listening to /clock, and return the function that sets this node's time.

    Where rospy does not go by /clock, the function does nothing.
    """
    subscriber = getattr(rospy.impl.simtime, "_clock_sub", None)
    if subscriber is None:
        return lambda _time: None
    subscriber.unregister()
    return rospy.rostime._set_rostime  # noqa: SLF001 - as the subscription did
