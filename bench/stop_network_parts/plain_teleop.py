"""A keyboard teleop as the upstream one behaves: plain Twist on each change, again at a rate, no proof of freshness.

Package teleop_twist_keyboard, which Debian does not have: a thread publishes the newest velocity when a key changes it
and `~repeat_rate` times a second; no key for `~key_timeout` means zero; zeros are repeated for ever.
"""

from __future__ import annotations

import select
import sys
import termios
import threading
import tty

import rospy
from geometry_msgs.msg import Twist

_MOVES = {"i": (1, 0), ",": (-1, 0), "j": (0, 1), "l": (0, -1), "u": (1, 1), ".": (-1, 1)}


class _Repeater(threading.Thread):
    """Publishes what it was given last."""

    def __init__(self, rate: float) -> None:
        super().__init__(daemon=True)
        self._publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self._condition = threading.Condition()
        self._velocity = (0.0, 0.0)
        self._timeout = 1.0 / rate if rate else None

    def update(self, forward: float, turn: float) -> None:
        """Publish this at once and from now on."""
        with self._condition:
            self._velocity = (forward, turn)
            self._condition.notify()

    def run(self) -> None:
        """See threading."""
        while not rospy.is_shutdown():
            with self._condition:
                self._condition.wait(self._timeout)
                message = Twist()
                message.linear.x, message.angular.z = self._velocity
            self._publisher.publish(message)


def main() -> int:
    """Run until Ctrl-C or shutdown. Returns the exit code."""
    settings = termios.tcgetattr(sys.stdin)
    rospy.init_node("teleop_twist_keyboard")
    speed, turn = rospy.get_param("~speed", 0.5), rospy.get_param("~turn", 1.0)
    timeout = rospy.get_param("~key_timeout", 0.5)
    repeater = _Repeater(rospy.get_param("~repeat_rate", 20.0))
    repeater.start()
    moves = False
    while not rospy.is_shutdown():
        tty.setraw(sys.stdin.fileno())
        key = sys.stdin.read(1) if select.select([sys.stdin], [], [], timeout)[0] else ""
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, settings)
        if key == "\x03":
            break
        ahead, round_ = _MOVES.get(key, (0, 0))
        if not key and not moves:
            continue
        moves = (ahead, round_) != (0, 0)
        repeater.update(ahead * speed, round_ * turn)
    return 0
