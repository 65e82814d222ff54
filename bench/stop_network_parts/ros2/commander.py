"""The commanders, one a process: commander KIND LANE NOTES. Standard input takes patterns by name, or an empty line.

`client` answers challenges and holds the lease, as all programs of this project; `plain` and `stamped` are programs of
ROS 2 that send Twist or TwistStamped to the base itself, reliably, with a queue, as Nav2 and teleop_twist_keyboard do.
Each notes when it publishes which velocity.
"""

import math
import sys
import time
from pathlib import Path

from bench.stop_network_parts.lane import PATTERNS
from bench.stop_network_parts.ros2.person import PERIOD, Person

from ur_nodes.client.driver_text import may_command
from ur_nodes.motion.challenge.link import FreshPublisher
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedTwist, Twist
from ur_nodes.run import run

_AGAIN = 1.0  # s


class Client:
    """A program of this project."""

    def __init__(self, node: Node, lane: str, person: Person, *, takes: bool) -> None:
        self._person = person
        self._asked_at = -math.inf
        self._lease = LeaseClient(node, f"/{lane}/cmd_vel_mux", "commander", conduct="take" if takes else "drive")
        self._publisher = FreshPublisher(f"/{lane}/key_vel", self._lease.link, self._lease.client)
        node.on_end(self._lease.release)
        node.every(PERIOD, self._send, steady=True)

    def _send(self) -> None:
        if not self._person.drives:
            return
        if not may_command(self._lease.view(), self._lease.conduct):
            if time.monotonic() - self._asked_at > _AGAIN:  # as a person presses the key to drive
                self._asked_at = time.monotonic()
                self._lease.acquire()
        else:
            speed = self._person.speed()
            self._person.note(speed)
            self._publisher.send(Twist(speed, 0.0))


class Foreign:
    """A program of others, as it sends to a base."""

    def __init__(self, node: Node, lane: str, person: Person, *, stamped: bool) -> None:
        self._node, self._person, self._stamped = node, person, stamped
        kind = StampedTwist if stamped else Twist
        self._publisher = node.publish(f"/{lane}/cmd_vel", kind, Quality.EVERY)
        node.every(PERIOD, self._send, steady=True)

    def _send(self) -> None:
        if self._person.drives:
            speed = self._person.speed()
            self._person.note(speed)
            twist = Twist(speed, 0.0)
            self._publisher.send(StampedTwist(self._node.now(), "base_link", twist) if self._stamped else twist)


def main(kind: str, lane: str, notes: str) -> int:
    """Run until shutdown. Returns the exit code."""
    person = Person(Path(notes), PATTERNS)

    def start(node: Node) -> object:
        if kind.startswith("client"):
            return Client(node, lane, person, takes=kind == "client-takes")
        return Foreign(node, lane, person, stamped=kind == "stamped")

    return run("commander", start)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:4]))
