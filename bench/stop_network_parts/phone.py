"""A client as a phone would be: it turns the robot while `j` or `l` is pressed, and shows one line on who drives.

Keys are those of the keyboard program: `d` takes over, `a` asks, `y` hands over, Ctrl-C ends.
"""

import os
import select
import sys
import threading
import time
import tty
from functools import partial

from ur_nodes.motion.challenge.link import FreshPublisher
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.motion.lease.view import LeaseView
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Twist
from ur_nodes.run import run_foreground

_HOLD = 0.2  # s
_PERIOD = 0.033  # s


class Phone:
    """Takes part in the lease, and sends commands whoever drives: the mux has to decide."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.speed = node.parameters.number("turn", 1.0)
        self.lease = LeaseClient(node, "cmd_vel_mux", "phone")
        self.commands = FreshPublisher("cmd_vel", self.lease.link, self.lease.client)
        node.on_end(self.lease.release)

    def turn(self, speed: float) -> None:
        """Send a command."""
        self.commands.send(Twist(0.0, speed))


def drive(phone: Phone, ended: threading.Event) -> int:
    """Obey keys until Ctrl-C or the end of the node. Returns the exit code."""
    tty.setraw(0)
    node, lease = phone.node, phone.lease
    turn, until = 0.0, 0.0
    ask = {"d": lease.take_over, "a": lease.ask, "y": lease.grant}
    while not ended.is_set():
        keys = os.read(0, 64).decode(errors="replace") if select.select([0], [], [], _PERIOD)[0] else ""
        for key in keys:
            if key in ask:
                node.post(ask[key])
            elif key in "jl":
                turn, until = phone.speed if key == "j" else -phone.speed, time.monotonic() + _HOLD
        if "\x03" in keys:
            break
        if time.monotonic() < until:
            node.post(partial(phone.turn, turn))
        sys.stdout.write(f"\x1b[H\x1b[J\x1b[1;1H{describe(lease.view())}\x1b[K")
        sys.stdout.flush()
    return 0


def main() -> int:
    """Run until Ctrl-C or shutdown. Returns the exit code."""
    return run_foreground("phone", Phone, drive)


def describe(view: LeaseView) -> str:
    """One line on who drives."""
    if view.mine:
        return "you drive"
    if view.taken_by and view.other:
        return f"{view.taken_by} took over"
    if view.other:
        return f"{view.holder} drives"
    return f"{view.holder} is out of reach" if view.state == "lost" else view.state
