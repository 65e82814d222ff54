"""Velocity commands that third-party programs send to the base itself, on a topic that the mux has taken over."""

from __future__ import annotations

from collections.abc import Callable

from ur_nodes.motion.velocity_kind import KindWatch
from ur_nodes.ports.node import Node, Sender, Subscription
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedTwist, Twist


class ForeignCommands:
    """Subscribes to Twist or TwistStamped, depending on the publishers; the stamp in a header is not trusted."""

    def __init__(self, node: Node, topic: str, take: Callable[[Twist, Sender | None], None]) -> None:
        self._node, self._topic, self._take = node, topic, take
        self._subscription: Subscription | None = None
        KindWatch(node, topic, node.kinds_sent, self._use, "commands are read as NAME, which programs send")

    def _use(self, kind: type) -> None:
        if self._subscription is not None:
            self._subscription.close()
        # Every command counts: a cluster has to be seen as one.
        if kind is Twist:
            self._subscription = self._node.subscribe_from(self._topic, Twist, self._take, Quality.EVERY)
        else:
            self._subscription = self._node.subscribe_from(
                self._topic, StampedTwist, lambda value, sender: self._take(value.twist, sender), Quality.EVERY
            )
