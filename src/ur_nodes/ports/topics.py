"""The ends of topics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

Sent = TypeVar("Sent", contravariant=True)


@dataclass(frozen=True, slots=True)
class Sender:
    """The sender of a value: the name of a node, and whether the value is one that the topic had kept (LATCHED).

    `id` distinguishes publishers, also those of one name. `sent` is the moment (ns) at which the value was sent, by the
    clock of the sender's computer, and `arrived` when it arrived (s), by `Node.steady`; None: it is not known.
    """

    name: str
    kept: bool = False
    id: str = ""
    sent: int | None = None
    arrived: float | None = None


class Publisher(Protocol[Sent]):
    """One end of a topic."""

    topic: str

    def send(self, value: Sent) -> None:
        """Send a value to all who listen. After the end of the node nothing happens."""

    def listeners(self) -> int:
        """The number of listeners: a value that is dear to make is made for listeners only."""

    def close(self) -> None:
        """Send no more."""


class Subscription(Protocol):
    """The other end of a topic."""

    topic: str

    def publishers(self) -> int:
        """The number of publishers."""

    def close(self) -> None:
        """Receive no more; what waits is dropped."""
