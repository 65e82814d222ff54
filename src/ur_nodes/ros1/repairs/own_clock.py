"""The simulated time of rospy: notification of changes, and the time of the node that publishes /clock.

rospy would send that node each stamp through a connection to itself.
"""

from __future__ import annotations

from collections.abc import Callable

import genpy
import rospy.impl.simtime
import rospy.rostime


def keep_own_clock() -> Callable[[genpy.Time], None]:
    """Stop listening to /clock, and return the function that sets this node's time.

    If rospy does not use /clock, the function does nothing.
    """
    subscriber = _subscriber()
    if subscriber is None:
        return lambda _time: None
    subscriber.unregister()
    return rospy.rostime._set_rostime  # noqa: SLF001 - as the subscription did


def follow_clock(call: Callable[[], None]) -> None:
    """Call after each message of /clock if rospy uses it, on the thread that receives them."""
    if (subscriber := _subscriber()) is not None:
        subscriber.impl.add_callback(lambda _message, _arguments: call(), ())


def _subscriber() -> rospy.Subscriber | None:
    return getattr(rospy.impl.simtime, "_clock_sub", None)
