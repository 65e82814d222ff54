"""A client as a phone would be: it turns the robot while `j` or `l` is pressed, and shows one line on who drives.

Keys are those of the keyboard program: `d` takes over, `a` asks, `y` hands over, Ctrl-C ends.
"""

from __future__ import annotations

import os
import select
import sys
import time
import tty

import rospy
from geometry_msgs.msg import Twist

from ur_nodes.motion.challenge.challenge_node import FreshPublisher
from ur_nodes.motion.lease.client_node import LeaseClient
from ur_nodes.motion.lease.view import LeaseView

_HOLD = 0.2  # s
_PERIOD = 0.033  # s


def main() -> int:
    """Run until Ctrl-C or shutdown. Returns the exit code."""
    tty.setraw(0)
    rospy.init_node("phone")
    lease = LeaseClient("cmd_vel_mux", "phone")
    publisher = FreshPublisher("cmd_vel", lease.link, lease.client)
    turn, until, speed = 0.0, 0.0, rospy.get_param("~turn", 1.0)
    ask = {"d": lease.take, "a": lease.ask, "y": lease.grant}
    while not rospy.is_shutdown():
        keys = os.read(0, 64).decode(errors="replace") if select.select([0], [], [], _PERIOD)[0] else ""
        for key in keys:
            if key in ask:
                ask[key]()
            elif key in "jl":
                turn, until = speed if key == "j" else -speed, time.monotonic() + _HOLD
        if "\x03" in keys:
            break
        if time.monotonic() < until:
            message = Twist()
            message.angular.z = turn
            publisher.publish(message)  # whoever drives: the mux has to decide
        sys.stdout.write(f"\x1b[H\x1b[J\x1b[1;1H{describe(lease.view())}\x1b[K")
        sys.stdout.flush()
    lease.release()
    return 0


def describe(view: LeaseView) -> str:
    """One line on who drives."""
    if view.mine:
        return "you drive"
    if view.taken_by and view.other:
        return f"{view.taken_by} took over"
    if view.other:
        return f"{view.holder} drives"
    return f"{view.holder} is out of reach" if view.state == "lost" else view.state
