"""Destination of a joystick's velocities: stamped commands for a mux with a lease, or plain ones for any subscriber."""

from typing import Protocol

from ur_nodes.motion.challenge.link import AdaptivePublisher, FreshPublisher
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Twist


class JoyCommander(Protocol):
    """Publishes velocities while the dead-man button is held and briefly afterwards. No call blocks."""

    def publish(self, twist: Twist, *, held: bool) -> None:
        """Publish a velocity; `held`: the dead-man button is held."""


class PlainJoyCommander:
    """Twist, for a base without a mux of ours."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.publish("cmd_vel", Twist)

    def publish(self, twist: Twist, *, held: bool) -> None:  # noqa: ARG002 - see JoyCommander
        """Publish a velocity."""
        self._publisher.send(twist)


class LeasedJoyCommander:
    """Stamped commands for a mux.

    The joystick drives while its dead-man button is held: pressing it requests the lease as UR_LEASE specifies, and
    releasing it releases a lease that was acquired so. A lease that the run had before, by its keyboard, is kept.
    """

    def __init__(self, node: Node, mux: str, *, adaptive: bool) -> None:
        """With `adaptive`, publish plain commands where there is no mux of ours: see AdaptivePublisher."""
        self._log = node.log
        self._lease = LeaseClient(node, mux, "joystick", conduct="watch")
        self._conduct = self._lease.identity.conduct
        publisher = AdaptivePublisher if adaptive else FreshPublisher
        self._publisher = publisher("cmd_vel", self._lease.link, self._lease.client)
        self._held = False
        self._borrowed = False
        self._sent: tuple[int | None, Twist] | None = None

    def publish(self, twist: Twist, *, held: bool) -> None:
        """Publish a velocity, unless another client drives. An unchanged one is not sent again."""
        if isinstance(self._publisher, AdaptivePublisher) and self._publisher.plain:
            self._publisher.send(twist)
            return
        view = self._lease.view()
        if held and not self._held:
            self._begin(mine=view.mine)
        if view.mine or (view.state == "free" and self._conduct != "watch"):
            what = (self._lease.link.newest(), twist)
            if what != self._sent or not held:
                self._publisher.send(twist)
                self._sent = what
        elif held:
            program = f" ({view.program})" if view.program else ""
            other = f"{view.holder}{program} drives" if view.state == "held" else "no mux has sent a lease"
            if view.state == "lost":
                other = f"{view.holder}{program} drove and is out of reach"
            way = "press the button again" if self._conduct == "take" else "UR_LEASE=take lets it take over"
            self._log.warn(f"the joystick does not drive: {other}; {way}", every=5.0)
        if self._held and not held and self._borrowed:
            self._borrowed = False
            self._lease.release(final=False)
        self._held = held

    def _begin(self, *, mine: bool) -> None:
        """Request the lease when the button is pressed."""
        self._borrowed = not mine and self._conduct != "watch"
        if mine or self._conduct == "watch":
            return
        {"drive": self._lease.acquire, "take": self._lease.take_over, "ask": self._lease.ask}[self._conduct]()


def make_joy_commander(node: Node, mux: str) -> JoyCommander:
    """Make the commander that the parameter `lease` selects. Raises UserError.

    It is `true`, `false` or `auto`: yes if there is a mux of ours, unless the commands go to a topic that is called
    cmd_vel, a base's own.
    """
    lease = node.parameters.text("lease", "auto", choices=("auto", "true", "false"))
    on_base = node.resolve("cmd_vel").rsplit("/", 1)[-1] == "cmd_vel"
    if lease == "true" or (lease == "auto" and not on_base):
        return LeasedJoyCommander(node, mux, adaptive=lease == "auto")
    return PlainJoyCommander(node)
