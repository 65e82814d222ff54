"""Velocities for a base, as the messages that its subscriber takes: Twist, or TwistStamped as many bases of ROS 2."""

from __future__ import annotations

from collections.abc import Callable

from ur_nodes.motion.mux_events import Velocity
from ur_nodes.motion.writes import AsideLog
from ur_nodes.ports.node import Node, Publisher
from ur_nodes.ports.values import StampedTwist, Twist

_LOOK = 0.25  # s: how often the graph is asked
_FRAME = "base_link"
_NAMES = {Twist: "Twist", StampedTwist: "TwistStamped"}


class BaseOutput:
    """Sends velocities on a topic. What subscribers take is asked for again and again, and logged when it changes.

    Both are sent where both have subscribers. While there is none, the last ones stay; where the middleware does not
    tell what subscribers take, it is Twist.
    """

    def __init__(self, node: Node, topic: str, greet: Callable[[], Velocity | None]) -> None:
        """`greet` is asked, when a node begins to listen, for what all listeners then get."""
        self._node, self._topic, self._greet = node, topic, greet
        self._log = AsideLog(node)
        self._twists: Publisher[Twist] | None = None
        self._stamped: Publisher[StampedTwist] | None = None
        self._taken: frozenset[type] = frozenset()
        taken = node.kinds_taken(topic, tuple(_NAMES))
        if taken is None:
            self._use(frozenset({Twist}))
        else:
            self._change(taken)
            node.every(_LOOK, self._look, steady=True)

    def send(self, velocity: Velocity) -> None:
        """Send a velocity."""
        if self._twists is not None:
            self._twists.send(_twist_of(velocity))
        if self._stamped is not None:
            self._stamped.send(self._stamp(velocity))

    def _look(self) -> None:
        self._change(self._node.kinds_taken(self._topic, tuple(_NAMES)) or frozenset())

    def _change(self, taken: frozenset[type]) -> None:
        if not taken or taken == self._taken:
            return
        names = " and ".join(name for kind, name in _NAMES.items() if kind in taken)
        self._log.info(f"{self._node.resolve(self._topic)}: velocities are sent as {names}, which its subscribers take")
        self._use(taken)

    def _use(self, taken: frozenset[type]) -> None:
        self._taken = taken
        if Twist not in taken and self._twists is not None:
            self._twists.close()
            self._twists = None
        elif Twist in taken and self._twists is None:
            self._twists = self._node.publish(self._topic, Twist, greet=self._greet_twist)
        if StampedTwist not in taken and self._stamped is not None:
            self._stamped.close()
            self._stamped = None
        elif StampedTwist in taken and self._stamped is None:
            self._stamped = self._node.publish(self._topic, StampedTwist, greet=self._greet_stamped)

    def _greet_twist(self) -> Twist | None:
        velocity = self._greet()
        return None if velocity is None else _twist_of(velocity)

    def _greet_stamped(self) -> StampedTwist | None:
        velocity = self._greet()
        return None if velocity is None else self._stamp(velocity)

    def _stamp(self, velocity: Velocity) -> StampedTwist:
        return StampedTwist(self._node.now(), _FRAME, _twist_of(velocity))


def _twist_of(velocity: Velocity) -> Twist:
    return Twist(velocity.forward, velocity.turn)
