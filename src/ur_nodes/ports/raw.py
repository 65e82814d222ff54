"""Messages of any type, by the middleware's names of types: for tools that show any topic of a robot.

Nodes of our own exchange the values of `ports.values` instead.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.topics import Publisher, Sender, Subscription
from ur_nodes.ports.values import Result

Fields = Mapping[str, object]
"""The fields of a message by name: numbers, texts, lists, and mappings of such; a time has `secs` and `nsecs`."""


@dataclass(frozen=True, slots=True)
class RawMessage:
    """A message as its publisher sent it; `schema` is the definition of its type and of those that it holds."""

    type_name: str
    schema: str
    data: bytes
    sender: Sender | None = None


@dataclass(frozen=True, slots=True)
class ServiceType:
    """The type of a service, and the schema of its requests."""

    name: str
    schema: str


@dataclass(frozen=True, slots=True)
class ServiceAnswer:
    """The answer of a service, and the name of the service's type."""

    type_name: str
    fields: Fields


@dataclass(frozen=True, slots=True)
class RecordedTopic:
    """A topic to record: the nodes that publish it, and the time (s) between two messages; 0 for all."""

    name: str
    publishers: tuple[str, ...] = ()
    period: float = 0.0


@dataclass(frozen=True, slots=True)
class RecordedType:
    """The type of the messages of a topic; `schema` is as in RawMessage."""

    topic: str
    type_name: str
    schema: str


class Recorded(NamedTuple):
    """A message, and the time at which it arrived by the clock of its recorder."""

    type: RecordedType
    time: int
    data: bytes


class Recorder(Protocol):
    """Records topics, as `Raw.record` made it."""

    def record(self, topics: Sequence[RecordedTopic]) -> None:
        """Record these topics, and no others. Called about once a second: what has failed is then tried again."""

    def close(self) -> None:
        """Record nothing any more."""


class Raw(Protocol):
    """Sends and receives messages of any type."""

    def find_schema(self, type_name: str) -> str | None:
        """Return the schema of a type; None if it is not installed. It may block: call it from `work`."""

    def subscribe(
        self, topic: str, take: Callable[[RawMessage], None], quality: Quality = Quality.NEWEST
    ) -> Subscription:
        """Subscribe to a topic of any type."""

    def record(self, take: Callable[[Sequence[Recorded]], None], clock: Callable[[], int]) -> Recorder:
        """Record topics at little cost: `take` gets messages in batches, with the times of `clock`, in ns."""

    def publish(self, topic: str, type_name: str, quality: Quality = Quality.EVERY) -> Publisher[Fields | bytes]:
        """Publish on a topic messages from fields, or from bytes. A header without a stamp gets the present time.

        Raises LookupError if the type is not installed. `send` raises ValueError for wrong fields.
        """

    def find_service(self, service: str, take: Callable[[Result], None]) -> None:
        """Find a service; `take` gets a result with its ServiceType."""

    def call(self, service: str, fields: Fields, take: Callable[[Result], None]) -> None:
        """Call a service without a timeout; `take` gets a result with its ServiceAnswer, as lines in the text."""
