"""Answers to the challenges of a mux, and velocity commands that carry them."""

import math
from collections.abc import Callable

from ur_nodes.motion.challenge.freshness import FRESHNESS
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedTwist, Time, Twist


class ChallengeLink:
    """Receives the challenges of a mux. `on_challenge` is called after each. Reads may come from any thread."""

    def __init__(self, node: Node, mux: str, on_challenge: Callable[[], None] | None = None) -> None:
        """`mux` is the name of the node that issues challenges."""
        self.node = node
        self._last = (0, -math.inf)  # the newest challenge (ns), and when it was received (s)
        self._on_challenge = on_challenge
        node.subscribe(f"{mux}/challenge", Time, self._handle_challenge)

    def newest(self, limit: float = FRESHNESS) -> int | None:
        """The newest challenge (ns) if it was received within the last `limit` seconds."""
        stamp, at = self._last
        return stamp if self.node.steady() - at <= limit else None

    def link_age(self) -> float:
        """Seconds since the last challenge was received; infinite before the first."""
        return self.node.steady() - self._last[1]

    @property
    def received(self) -> bool:
        """Return whether a challenge has ever been received."""
        return self._last[1] > -math.inf

    def _handle_challenge(self, challenge: Time) -> None:
        self._last = (challenge.stamp, self.node.steady())
        if self._on_challenge:
            self._on_challenge()


class FreshPublisher:
    """Publishes velocity commands that answer challenges, as StampedTwist on `<topic>_stamped`.

    `<topic>` is the topic of plain commands, remapped as usual: `cmd_vel:=nav_vel` makes it `nav_vel_stamped`.
    """

    def __init__(self, topic: str, link: ChallengeLink, client: str = "") -> None:
        """`client` is the id of the client that drives; empty for a node on the robot that follows the lease itself."""
        self._link = link
        self.client = client
        self._publisher = link.node.publish(stamped_name(link.node, topic), StampedTwist, Quality.FRESH)

    def send(self, twist: Twist) -> bool:
        """Publish a command with the newest challenge; without one publish nothing and return False."""
        answer = self._link.newest()
        if answer is None:
            return False
        self._publisher.send(StampedTwist(answer, self.client, twist))
        return True

    @property
    def topic(self) -> str:
        """The full name of the topic."""
        return self._publisher.topic

    def subscribers(self) -> int:
        """The number of subscribers."""
        return self._publisher.subscribers()


class AdaptivePublisher:
    """Publishes stamped commands; or plain ones where only those have subscribers and no challenge was ever received.

    So a node drives by upstream's twist_mux and by a base's own topic too, but never by plain commands where there is a
    mux that knows the age of stamped ones.
    """

    def __init__(self, topic: str, link: ChallengeLink, client: str) -> None:
        """`client` is the id of the client that drives."""
        self._link = link
        self._fresh = FreshPublisher(topic, link, client)
        self._plain = link.node.publish(topic, Twist)

    @property
    def plain(self) -> bool:
        """Return whether commands are now published as plain ones."""
        return not self._link.received and not self._fresh.subscribers() and self._plain.subscribers() > 0

    def send(self, twist: Twist) -> None:
        """Publish a command if it can be stamped, or as a plain one if `plain`."""
        if self.plain:
            self._plain.send(twist)
        else:
            self._fresh.send(twist)

    @property
    def topic(self) -> str:
        """The full name of the topic in use."""
        return self._plain.topic if self.plain or not self._fresh.subscribers() else self._fresh.topic

    def subscribers(self) -> int:
        """The number of subscribers of the topic in use."""
        return self._plain.subscribers() if self.plain else self._fresh.subscribers()


def stamped_name(node: Node, topic: str) -> str:
    """The full name of the topic for stamped commands, beside `topic` after remapping unless it is remapped itself."""
    own = node.resolve(f"{topic}_stamped")
    above = node.name if topic.startswith("~") else node.name.rpartition("/")[0]
    unmapped = topic if topic.startswith("/") else f"{above}/{topic.removeprefix('~')}"
    return own if own != f"{unmapped}_stamped" else f"{node.resolve(topic)}_stamped"
