"""Messages of any type on a bus: bytes and fields are sent unchanged, values of a kind as their text."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

from ur_nodes.memory.carrier import Carrier, type_name_of
from ur_nodes.ports.node import Publisher, Sender, Subscription, Timer
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import Fields, RawMessage, RecordingRaw


class RawNode(Protocol):
    """The node of `MemoryRaw`; `type_name` is the middleware's name of a type that is of no kind."""

    def publish(
        self, topic: str, kind: type[object], quality: Quality, on_subscriber: None = None, type_name: str = ""
    ) -> Publisher[object]:
        """See Node."""

    def subscribe_from(
        self, topic: str, kind: type[object], callback: Callable[[object, Sender | None], None], quality: Quality
    ) -> Subscription:
        """See Node."""

    def resolve(self, name: str) -> str:
        """See Node."""

    def after(self, seconds: float, call: Callable[[], None]) -> Timer:
        """See Node."""


class TypedFields(dict[str, object]):
    """The fields of a message, with the name of its type."""

    type_name = ""


class MemoryRaw(RecordingRaw):
    """See `ports.raw.Raw`. Types are those of the bus's `schemas`."""

    encoding = ""

    def __init__(self, node: RawNode, bus: Carrier) -> None:
        self._node, self._bus = node, bus

    def find_schema(self, type_name: str) -> str | None:
        return self._bus.schemas.get(type_name)

    def subscribe(
        self, topic: str, callback: Callable[[RawMessage], None], quality: Quality = Quality.NEWEST
    ) -> Subscription:
        return self._node.subscribe_from(
            topic, object, lambda value, sender: callback(self._raw_of(value, sender)), quality
        )

    def publish(self, topic: str, type_name: str, quality: Quality = Quality.EVERY) -> MemoryRawPublisher:
        if type_name not in self._bus.schemas:
            raise LookupError(type_name)
        return MemoryRawPublisher(self._node.publish(topic, object, quality, type_name=type_name), type_name, self._bus)

    def _raw_of(self, value: object, sender: Sender | None) -> RawMessage:
        if isinstance(value, RawMessage):
            return replace(value, sender=sender)
        if isinstance(value, TypedFields):
            schema = self._bus.schemas[value.type_name]
            return RawMessage(value.type_name, schema, json.dumps(value).encode(), sender)
        return RawMessage(type_name_of(type(value)), "", repr(value).encode(), sender)


class MemoryRawPublisher:
    """See `ports.node.Publisher`."""

    def __init__(self, publisher: Publisher[object], type_name: str, bus: Carrier) -> None:
        self.topic, self._publisher = publisher.topic, publisher
        self._type_name, self._schema = type_name, bus.schemas[type_name]

    def send(self, value: Fields | bytes) -> None:
        if isinstance(value, bytes):
            self._publisher.send(RawMessage(self._type_name, self._schema, value))
            return
        for name, each in value.items():
            if name not in self._schema:
                raise ValueError(f"No field name [{name}]")
            if f"string {name}" in self._schema and not isinstance(each, str):
                raise ValueError(f"{name}: {type(each).__name__}, expected a text")
        fields = TypedFields(value)
        fields.type_name = self._type_name
        self._publisher.send(fields)

    def subscribers(self) -> int:
        return self._publisher.subscribers()

    def close(self) -> None:
        self._publisher.close()
