"""The simulated time of rospy: notification of changes, and the time of the node that publishes /clock.

rospy would send that node each stamp through a connection to itself.
"""

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
    return _set_time


def _set_time(time: genpy.Time) -> None:
    """Set the time as rospy does, which calls `notify_all` by a name that costs a warning each time."""
    rospy.rostime._rostime_current = rospy.Time(time.secs, time.nsecs)  # noqa: SLF001 - rospy has no other name
    with (changed := rospy.rostime._rostime_cond):  # noqa: SLF001 - likewise
        changed.notify_all()


def follow_clock(call: Callable[[], None]) -> None:
    """Call after each message of /clock if rospy uses it, on the thread that receives them."""
    if (subscriber := _subscriber()) is not None:
        subscriber.impl.add_callback(lambda _message, _arguments: call(), ())


def _subscriber() -> rospy.Subscriber | None:
    return getattr(rospy.impl.simtime, "_clock_sub", None)
