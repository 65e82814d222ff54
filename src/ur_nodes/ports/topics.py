"""Publishers and subscriptions of topics."""

from typing import NamedTuple, Protocol, TypeVar

Sent = TypeVar("Sent", contravariant=True)


class Sender(NamedTuple):
    """The sender of a value: the name of its node, and whether the value was stored by the topic (LATCHED).

    `id` distinguishes publishers, also those of one name. Where the middleware cannot tell several of them apart, they
    have one `id`, and values of one `stream` are of one publisher, which may have several streams. `sent` is the moment
    (ns) at which the value was sent, by the clock of the sender's computer, and `arrived` when it arrived (s), by
    `Node.steady`; None: it is not known.
    """

    name: str
    kept: bool = False
    id: str = ""
    sent: int | None = None
    arrived: float | None = None
    stream: str = ""


class Publisher(Protocol[Sent]):
    """A publisher of a topic."""

    topic: str

    def send(self, value: Sent) -> None:
        """Send a value to all subscribers. After the end of the node nothing happens."""

    def subscribers(self) -> int:
        """Return the number of subscribers, so that expensive values are made for subscribers only."""

    def close(self) -> None:
        """Close the publisher."""


class Subscription(Protocol):
    """A subscription of a topic."""

    topic: str

    def publishers(self) -> int:
        """Return the number of publishers."""

    def close(self) -> None:
        """Close the subscription; waiting values are dropped."""
