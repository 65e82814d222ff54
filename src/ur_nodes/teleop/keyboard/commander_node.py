"""Destination of the keys' velocities: stamped commands for a mux with a lease, or plain ones for any subscriber."""

from __future__ import annotations

import threading
import time
from typing import Any, Protocol

import rospy
from geometry_msgs.msg import Twist, TwistStamped, Vector3

from ur_nodes.client.driver_text import DriverRequest, may_command
from ur_nodes.motion.challenge.challenge_node import AdaptivePublisher, FreshPublisher
from ur_nodes.motion.lease.client_node import LeaseClient
from ur_nodes.motion.lease.view import Conduct, LeaseView
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.teleop.keyboard.drive import Motion
from ur_nodes.teleop.keyboard.drive_screen import Link
from ur_nodes.teleop.terminal.wake import Wake

_CHOICES = ("auto", "true", "false")


class Commander(Protocol):
    """Publishes velocities, and knows who drives. No call but `close` blocks."""

    wake: Wake
    conduct: Conduct

    def publish(self, motion: Motion) -> None:
        """Publish a velocity, unless another client drives."""

    def link(self) -> Link:
        """The topic and its subscribers."""

    def view(self) -> LeaseView | None:
        """Return the lease as this client sees it; None where there is no lease."""

    def request(self, request: DriverRequest) -> None:
        """Change who drives."""

    def close(self) -> None:
        """Release the lease."""


class LeasedCommander:
    """Stamped commands for a mux. `wake` rings whenever a challenge has arrived: the moment to answer it."""

    def __init__(self, mux: str, program: str, *, adaptive: bool) -> None:
        """With `adaptive`, publish plain commands where there is no mux of ours: see AdaptivePublisher."""
        self.wake = Wake()
        self._lease = LeaseClient(mux, program, on_challenge=self.wake.ring)
        self.conduct = self._lease.conduct
        publisher = AdaptivePublisher if adaptive else FreshPublisher
        self._publisher = publisher("cmd_vel", self._lease.link, self._lease.client)

    def publish(self, motion: Motion) -> None:
        """Publish a velocity, unless another client drives."""
        if self._plain or may_command(self._lease.view(), self.conduct):
            self._publisher.publish(twist_of(motion))

    def link(self) -> Link:
        """The topic and its subscribers."""
        return Link(self._publisher.topic, self._publisher.listeners())

    def view(self) -> LeaseView | None:
        """Return the lease as this client sees it; None where there is no lease."""
        return None if self._plain else self._lease.view()

    def settle(self, seconds: float) -> LeaseView | None:
        """Wait at most so long until the lease has been requested as the conduct demands, and return the view of it."""
        return None if self._plain else self._lease.settle(seconds)

    @property
    def _plain(self) -> bool:
        return isinstance(self._publisher, AdaptivePublisher) and self._publisher.plain

    def request(self, request: DriverRequest) -> None:
        """Change who drives."""
        {"take": self._lease.take, "ask": self._lease.ask, "grant": self._lease.grant}[request]()

    def close(self) -> None:
        """Release the lease."""
        self._lease.release()


class PlainCommander:
    """Twist, or TwistStamped with the time as upstream's `~stamped` has it, for a base without a mux of ours."""

    conduct: Conduct = "drive"

    def __init__(self, *, stamped: bool, frame: str) -> None:
        self.wake = Wake()
        self._stamped = stamped
        self._frame = frame
        self._publisher: Any = rospy.Publisher("cmd_vel", TwistStamped if stamped else Twist, queue_size=1)

    def publish(self, motion: Motion) -> None:
        """Publish a velocity."""
        if not self._stamped:
            self._publisher.publish(twist_of(motion))
            return
        message = TwistStamped(twist=twist_of(motion))
        message.header.stamp, message.header.frame_id = rospy.Time.now(), self._frame
        self._publisher.publish(message)

    def link(self) -> Link:
        """The topic and its subscribers."""
        return Link(self._publisher.resolved_name, self._publisher.get_num_connections())

    def view(self) -> None:
        """There is no lease."""

    def request(self, request: DriverRequest) -> None:
        """There is no lease."""

    def close(self) -> None:
        """There is no lease."""


def make_commander(parameters: Parameters, mux: str, program: str) -> LeasedCommander | PlainCommander:
    """The commander that the parameters `lease`, `stamped` and `frame_id` ask for. Raises UserError.

    `lease` is `true`, `false` or `auto`: yes if there is a mux of ours, unless the commands go to a topic that is
    called cmd_vel, which is a base's own, or are to be stamped with the time.
    """
    stamped = parameters.boolean("stamped", False)
    lease = parameters.text("lease", "auto", choices=_CHOICES)
    on_base = rospy.resolve_name("cmd_vel").rsplit("/", 1)[-1] == "cmd_vel"
    if lease == "true" or (lease == "auto" and not stamped and not on_base):
        return LeasedCommander(mux, program, adaptive=lease == "auto")
    return PlainCommander(stamped=stamped, frame=parameters.text("frame_id", ""))


def wait_for_listener(commander: Commander, ended: threading.Event, seconds: float) -> bool:
    """Wait for a subscriber, at most so long; return whether there is one."""
    deadline = time.monotonic() + seconds
    while not commander.link().listeners:
        if time.monotonic() > deadline or ended.wait(0.05):
            return False
    return True


def twist_of(motion: Motion) -> Twist:
    """The message."""
    return Twist(Vector3(motion.x, motion.y, motion.z), Vector3(0.0, 0.0, motion.yaw))
