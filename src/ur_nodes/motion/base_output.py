"""Publisher of velocities for a base, as the type that its subscriber has."""

from __future__ import annotations

from collections.abc import Callable

from ur_nodes.motion.mux_events import Velocity
from ur_nodes.motion.velocity_kind import KindWatch
from ur_nodes.ports.node import Node, Publisher
from ur_nodes.ports.values import StampedTwist, Twist

_FRAME = "base_link"


class BaseOutput:
    """Sends velocities on a topic, as Twist or TwistStamped. See KindWatch: while none is known, nothing is sent."""

    def __init__(self, node: Node, topic: str, on_subscriber: Callable[[], Velocity | None]) -> None:
        """`on_subscriber` returns, for each new subscriber, a value that all subscribers then get."""
        self._node, self._topic, self._on_subscriber = node, topic, on_subscriber
        self._twists: Publisher[Twist] | None = None
        self._stamped: Publisher[StampedTwist] | None = None
        KindWatch(node, topic, node.subscribed_kinds, self._use, "velocities are sent as NAME, which the base takes")

    def send(self, velocity: Velocity) -> None:
        """Send a velocity."""
        if self._twists is not None:
            self._twists.send(_twist_of(velocity))
        elif self._stamped is not None:
            self._stamped.send(self._stamp(velocity))

    def _use(self, kind: type) -> None:
        for publisher in (self._twists, self._stamped):
            if publisher is not None:
                publisher.close()
        self._twists = self._stamped = None
        if kind is Twist:
            self._twists = self._node.publish(self._topic, Twist, on_subscriber=self._on_subscriber_twist)
        else:
            self._stamped = self._node.publish(self._topic, StampedTwist, on_subscriber=self._on_subscriber_stamped)

    def _on_subscriber_twist(self) -> Twist | None:
        velocity = self._on_subscriber()
        return None if velocity is None else _twist_of(velocity)

    def _on_subscriber_stamped(self) -> StampedTwist | None:
        velocity = self._on_subscriber()
        return None if velocity is None else self._stamp(velocity)

    def _stamp(self, velocity: Velocity) -> StampedTwist:
        return StampedTwist(self._node.now(), _FRAME, _twist_of(velocity))


def _twist_of(velocity: Velocity) -> Twist:
    return Twist(velocity.forward, velocity.turn, velocity.left)
