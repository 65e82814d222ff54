"""`challenge.link` for nodes that still use rospy's threads and messages."""

from __future__ import annotations

from collections.abc import Callable

import rospy
from geometry_msgs.msg import Twist

from ur_nodes.codecs.motion import twist_of
from ur_nodes.motion.challenge import link as ports
from ur_nodes.motion.challenge.freshness import FRESHNESS
from ur_nodes.ros1.node import RosNode

_NANO = 1_000_000_000


class ChallengeLink(ports.ChallengeLink):
    """`on_challenge` is called on a thread of its own; it must not block."""

    def __init__(self, mux: str, on_challenge: Callable[[], None] | None = None, node: RosNode | None = None) -> None:
        """`mux` is the name of the node that issues challenges; `node` is begun by its maker."""
        own = node or RosNode()
        super().__init__(own, mux, on_challenge)
        if node is None:
            own.begin()

    def answer(self, limit: float = FRESHNESS) -> rospy.Time | None:
        """The newest challenge if it was received within the last `limit` seconds."""
        stamp = self.newest(limit)
        return None if stamp is None else rospy.Time(*divmod(stamp, _NANO))


class FreshPublisher(ports.FreshPublisher):
    """Takes messages."""

    def publish(self, twist: Twist) -> bool:
        """See `send`."""
        return self.send(twist_of(twist))


class AdaptivePublisher(ports.AdaptivePublisher):
    """Takes messages."""

    def publish(self, twist: Twist) -> None:
        """See `send`."""
        self.send(twist_of(twist))
