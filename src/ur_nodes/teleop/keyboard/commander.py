"""Destination of the keys' velocities: stamped commands for a mux with a lease, or plain ones for any subscriber."""

import math
from collections.abc import Callable
from typing import Protocol

from ur_nodes.client.driver_text import DriverRequest, clock_time, describe_lost, may_command, name_holder
from ur_nodes.motion.challenge.link import AdaptivePublisher, FreshPublisher
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.motion.lease.view import Conduct, LeaseView
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import StampedTwist, Twist
from ur_nodes.teleop.keyboard.drive import KeyVelocity
from ur_nodes.teleop.keyboard.drive_screen import CommandTopic

_CHOICES = ("auto", "true", "false")


class Commander(Protocol):
    """Publishes velocities, and requests the lease where there is one."""

    conduct: Conduct

    def send(self, motion: KeyVelocity) -> None:
        """Publish a velocity, unless another client drives."""

    def link(self) -> CommandTopic:
        """The topic and its subscribers."""

    def view(self) -> LeaseView | None:
        """Return the lease as this client sees it; None where there is no lease."""

    def settled(self) -> bool:
        """Return whether the lease has been requested as the conduct demands."""

    def request(self, request: DriverRequest) -> None:
        """Change who drives."""

    def watch(self, call: Callable[[], None]) -> None:
        """Call after each challenge: the moment to answer it."""

    def close(self) -> None:
        """Release the lease."""


def call_in_time(
    node: Node, commander: Commander, rate: float, call: Callable[[], None], moving: Callable[[], bool]
) -> None:
    """Make a call at a rate (Hz); while `moving`, instead after each challenge, as long as these arrive as often."""
    called_at = -math.inf

    def answer() -> None:
        nonlocal called_at
        if moving():
            called_at = node.steady()
            call()

    def beat() -> None:
        if node.steady() - called_at > 1.0 / rate:
            call()

    commander.watch(answer)
    node.every(1.0 / rate, beat, steady=True)


class LeasedCommander:
    """Stamped commands for a mux."""

    def __init__(self, node: Node, mux: str, program: str, *, adaptive: bool) -> None:
        """With `adaptive`, publish plain commands where there is no mux of ours: see AdaptivePublisher."""
        self._calls: list[Callable[[], None]] = []
        self._lease = LeaseClient(node, mux, program, on_challenge=self._pass_on)
        self.conduct = self._lease.conduct
        publisher = AdaptivePublisher if adaptive else FreshPublisher
        self._publisher = publisher("cmd_vel", self._lease.link, self._lease.client)

    def send(self, motion: KeyVelocity) -> None:
        """Publish a velocity, unless another client drives."""
        if self._plain or may_command(self._lease.view(), self.conduct):
            self._publisher.send(twist_of(motion))

    def link(self) -> CommandTopic:
        """The topic and its subscribers."""
        return CommandTopic(self._publisher.topic, self._publisher.subscribers())

    def view(self) -> LeaseView | None:
        """Return the lease as this client sees it; None where there is no lease."""
        return None if self._plain else self._lease.view()

    def settled(self) -> bool:
        """Return whether the lease has been requested as the conduct demands."""
        return self._plain or self._lease.settled

    def request(self, request: DriverRequest) -> None:
        """Change who drives."""
        self._lease.request(request)

    def watch(self, call: Callable[[], None]) -> None:
        """Call after each challenge: the moment to answer it."""
        self._calls.append(call)

    def close(self) -> None:
        """Release the lease."""
        self._lease.release()

    @property
    def _plain(self) -> bool:
        return isinstance(self._publisher, AdaptivePublisher) and self._publisher.plain

    def _pass_on(self) -> None:
        for call in self._calls:
            call()


class PlainCommander:
    """Twist, or TwistStamped with the time as upstream's `~stamped` has it, for a base without a mux of ours."""

    conduct: Conduct = "drive"

    def __init__(self, node: Node, *, stamped: bool, frame: str) -> None:
        self._node, self._frame = node, frame
        self._stamped = node.publish("cmd_vel", StampedTwist) if stamped else None
        self._plain = None if stamped else node.publish("cmd_vel", Twist)

    def send(self, motion: KeyVelocity) -> None:
        """Publish a velocity."""
        if self._stamped:
            self._stamped.send(StampedTwist(self._node.now(), self._frame, twist_of(motion)))
        elif self._plain:
            self._plain.send(twist_of(motion))

    def link(self) -> CommandTopic:
        """The topic and its subscribers."""
        publisher = self._stamped or self._plain
        assert publisher is not None, "one of them is made"
        return CommandTopic(publisher.topic, publisher.subscribers())

    def view(self) -> None:
        """There is no lease."""

    def settled(self) -> bool:
        """There is no lease."""
        return True

    def request(self, request: DriverRequest) -> None:
        """There is no lease."""

    def watch(self, call: Callable[[], None]) -> None:
        """There are no challenges."""

    def close(self) -> None:
        """There is no lease."""


def make_commander(node: Node, mux: str, program: str) -> Commander:
    """Make the commander that the parameters `lease`, `stamped` and `frame_id` choose. Raises UserError.

    `lease` is `true`, `false` or `auto`: yes if there is a mux of ours, unless the commands go to a topic that is
    called cmd_vel, which is a base's own, or are to be stamped with the time.
    """
    stamped = node.parameters.boolean("stamped", False)
    lease = node.parameters.text("lease", "auto", choices=_CHOICES)
    on_base = node.resolve("cmd_vel").rsplit("/", 1)[-1] == "cmd_vel"
    if lease == "true" or (lease == "auto" and not stamped and not on_base):
        return LeasedCommander(node, mux, program, adaptive=lease == "auto")
    return PlainCommander(node, stamped=stamped, frame=node.parameters.text("frame_id", ""))


def explain_refusal(commander: Commander) -> str:
    """Return the reason why a pipe must not drive; empty if it may."""
    view = commander.view()
    if view is None or may_command(view, commander.conduct):
        return ""
    if view.state == "unknown":
        return "no challenge from the mux, expected a robot that runs one (_lease:=false needs no mux)"
    if view.state == "free":
        return "UR_LEASE is watch, expected drive or take"
    if view.lost_by_other:
        return f"{describe_lost(view, 'the robot')}; expected a robot that no client drives (UR_LEASE=take takes over)"
    since = f"{name_holder(view)} drives the robot since {clock_time(view.since)}"
    return f"{since}; expected a robot that no client drives (UR_LEASE=take takes over)"


def twist_of(motion: KeyVelocity) -> Twist:
    """Return the twist of a velocity."""
    return Twist(motion.x, motion.yaw, motion.y, motion.z)
