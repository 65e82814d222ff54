"""Answers to the challenges of a mux, and velocity commands that carry them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import rosgraph.names
import rospy
from geometry_msgs.msg import Twist, TwistStamped
from std_msgs.msg import Time

from ur_nodes.motion.challenge.freshness import FRESHNESS


class ChallengeLink:
    """Receives the challenges of a mux. `on_challenge` is called in rospy's thread after each; it must not block."""

    def __init__(self, mux: str, on_challenge: Callable[[], None] | None = None) -> None:
        """`mux` is the name of the node that issues challenges."""
        self._lock = threading.Lock()
        self._newest = rospy.Time()
        self._received_at = float("-inf")
        self._on_challenge = on_challenge
        rospy.Subscriber(f"{mux}/challenge", Time, self._on_message, queue_size=1, tcp_nodelay=True)

    def answer(self, limit: float = FRESHNESS) -> rospy.Time | None:
        """The newest challenge if it was received within the last `limit` seconds."""
        with self._lock:
            return self._newest if time.monotonic() - self._received_at <= limit else None

    def link_age(self) -> float:
        """Seconds since the last challenge was received; infinite before the first."""
        with self._lock:
            return time.monotonic() - self._received_at

    @property
    def received(self) -> bool:
        """Return whether a challenge has ever been received."""
        return self.link_age() < float("inf")

    def _on_message(self, message: Time) -> None:
        with self._lock:
            self._newest, self._received_at = message.data, time.monotonic()
        if self._on_challenge:
            self._on_challenge()


class FreshPublisher:
    """Publishes velocity commands that answer challenges, as TwistStamped on `<topic>_stamped`.

    `<topic>` is the topic of plain commands, remapped as usual: `cmd_vel:=nav_vel` makes it `nav_vel_stamped`.
    """

    def __init__(self, topic: str, link: ChallengeLink, client: str = "") -> None:
        """`client` is the id of the client that drives; empty for a node on the robot that follows the lease itself."""
        self._link = link
        self.client = client
        self._publisher = rospy.Publisher(stamped_name(topic), TwistStamped, queue_size=1, tcp_nodelay=True)

    def publish(self, twist: Twist) -> bool:
        """Publish a command with the newest challenge; without one publish nothing and return False."""
        answer = self._link.answer()
        if answer is None:
            return False
        message = TwistStamped(twist=twist)
        message.header.stamp, message.header.frame_id = answer, self.client
        self._publisher.publish(message)
        return True

    @property
    def topic(self) -> str:
        """The full name of the topic."""
        return str(self._publisher.resolved_name)

    def listeners(self) -> int:
        """The number of subscribers."""
        return int(self._publisher.get_num_connections())


class AdaptivePublisher:
    """Publishes stamped commands; or plain ones where only those have subscribers and no challenge was ever received.

    So a node drives by upstream's twist_mux and by a base's own topic too, but never by plain commands where there is a
    mux that knows the age of stamped ones.
    """

    def __init__(self, topic: str, link: ChallengeLink, client: str) -> None:
        """`client` is the id of the client that drives."""
        self._link = link
        self._fresh = FreshPublisher(topic, link, client)
        self._plain = rospy.Publisher(topic, Twist, queue_size=1, tcp_nodelay=True)

    @property
    def plain(self) -> bool:
        """Return whether commands are published as plain ones now."""
        return not self._link.received and not self._fresh.listeners() and self._plain.get_num_connections() > 0

    def publish(self, twist: Twist) -> None:
        """Publish a command, if it can be stamped or is to be plain."""
        if self.plain:
            self._plain.publish(twist)
        else:
            self._fresh.publish(twist)

    @property
    def topic(self) -> str:
        """The full name of the topic in use."""
        return str(self._plain.resolved_name) if self.plain or not self._fresh.listeners() else self._fresh.topic

    def listeners(self) -> int:
        """The number of subscribers of the topic in use."""
        return int(self._plain.get_num_connections()) if self.plain else self._fresh.listeners()


def stamped_name(topic: str) -> str:
    """The full name of the topic for stamped commands, beside `topic` after remapping unless it is remapped itself."""
    own = str(rospy.resolve_name(f"{topic}_stamped"))
    if own != rosgraph.names.resolve_name(f"{topic}_stamped", rospy.get_name()):
        return own
    return f"{rospy.resolve_name(topic)}_stamped"
