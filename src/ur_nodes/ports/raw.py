"""Messages of any type, by the middleware's names of types: for tools that show any topic of a robot.

Nodes of our own exchange the values of `ports.values` instead.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

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


class Raw(Protocol):
    """Sends and receives messages of any type."""

    def find_schema(self, type_name: str) -> str | None:
        """Return the schema of a type; None if it is not installed. It may block: call it from `work`."""

    def subscribe(
        self, topic: str, take: Callable[[RawMessage], None], quality: Quality = Quality.NEWEST
    ) -> Subscription:
        """Subscribe to a topic of any type."""

    def publish(self, topic: str, type_name: str, quality: Quality = Quality.EVERY) -> Publisher[Fields | bytes]:
        """Publish on a topic messages from fields, or from bytes. A header without a stamp gets the present time.

        Raises LookupError if the type is not installed. `send` raises ValueError for wrong fields.
        """

    def find_service(self, service: str, take: Callable[[Result], None]) -> None:
        """Find a service; `take` gets a result with its ServiceType."""

    def call(self, service: str, fields: Fields, take: Callable[[Result], None]) -> None:
        """Call a service without a timeout; `take` gets a result with its ServiceAnswer, as lines in the text."""
