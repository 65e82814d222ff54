"""Publishers, subscriptions and timers of a bus."""

from __future__ import annotations

from collections.abc import Callable

from ur_nodes.memory.carrier import BusListener, Carrier, Offer


class MemoryPublisher:
    """See `ports.node.Publisher`."""

    def __init__(self, bus: Carrier, topic: str, offer: Offer) -> None:
        self.topic = topic
        self._bus, self._offer = bus, offer

    def send(self, value: object) -> None:
        if self._offer in self._bus.topics[self.topic].offers:
            self._bus.send(self.topic, self._offer, value)

    def listeners(self) -> int:
        return len(self._bus.topics[self.topic].listeners)

    def close(self) -> None:
        self._offer.latched, self._offer.greet, self._offer.kept = False, None, None


class MemorySubscription:
    """See `ports.node.Subscription`."""

    def __init__(self, bus: Carrier, topic: str, listener: BusListener, forget: Callable[[], None]) -> None:
        self.topic = topic
        self._bus, self._listener, self._forget = bus, listener, forget

    def publishers(self) -> int:
        return len(self._bus.topics[self.topic].offers)

    def close(self) -> None:
        if self._listener.open:
            self._listener.open = False
            self._bus.topics[self.topic].listeners.remove(self._listener)
            self._forget()


class MemoryTimer:
    """See `ports.node.Timer`."""

    def __init__(self) -> None:
        self.on = True

    def cancel(self) -> None:
        self.on = False
