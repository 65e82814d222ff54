"""Subscribers to a run, over its socket or an open file: each gets its events, and none can delay the run."""

from __future__ import annotations

import os
import select
import socket
from collections.abc import Callable, Iterable

from ur.run.clients.protocol import (
    BadLineError,
    Notice,
    OutputLine,
    RunCommand,
    RunEvent,
    StatsSampled,
    Synchronised,
    Watch,
    dump_line,
    parse_command,
)
from ur.run.output.console import Sink

MOST_COMMAND_BYTES = 64 * 1024
MOST_BACKLOG = 20_000  # events; a client that does not read for so long is disconnected


class Subscribers:
    """All subscribers. `descriptors` are for polling; `attend` handles an event on one of them."""

    def __init__(self, listener: socket.socket | None, describe_state: Callable[[], Iterable[RunEvent]]) -> None:
        """Take a listening socket, and a source of the events that describe the current state to a new subscriber."""
        self._listener = listener
        self._describe_state = describe_state
        self._subscribers: dict[int, _Subscriber] = {}
        self.on_removed: Callable[[int], None] | None = None  # before a descriptor is closed

    def add_socket(self, link: socket.socket) -> int:
        """Add a client that may also send commands; return its descriptor, which identifies it."""
        link.setblocking(False)
        return self._add(_Subscriber(link.fileno(), link, Watch()))

    def add_output(self, descriptor: int, watch: Watch) -> int:
        """Add an open file that events are written to, and that is never read; return its descriptor."""
        return self._add(_Subscriber(descriptor, None, watch))

    def descriptors(self) -> dict[int, int]:
        """Poll event masks by descriptor."""
        found = {} if self._listener is None else {self._listener.fileno(): select.POLLIN}
        for descriptor, subscriber in self._subscribers.items():
            wanted = (select.POLLIN if subscriber.link is not None else 0) | (
                select.POLLOUT if subscriber.sink.waiting else 0
            )
            if wanted:
                found[descriptor] = wanted
        return found

    def holds(self, descriptor: int) -> bool:
        """Test for a descriptor of a connected subscriber."""
        return descriptor in self._subscribers

    def wanted(self) -> Watch:
        """The union of all subscribers' subscriptions."""
        watches = [subscriber.watch for subscriber in self._subscribers.values()]
        return Watch(
            output=any(watch.output for watch in watches),
            stats=any(watch.stats for watch in watches),
            readiness=any(watch.readiness for watch in watches),
        )

    def publish(self, event: RunEvent) -> None:
        """Send an event to the subscribers that asked for its kind."""
        if not self._subscribers:
            return
        line = b""
        for descriptor, subscriber in list(self._subscribers.items()):
            if not subscriber.wants(event):
                continue
            line = line or dump_line(event)
            source = event.name if isinstance(event, OutputLine) else ""
            subscriber.sink.put(line, important=not isinstance(event, (OutputLine, StatsSampled)), source=source)
            if subscriber.sink.backlog > MOST_BACKLOG:
                self._drop(descriptor)

    def attend(self, descriptor: int) -> list[RunCommand]:
        """Accept, read and write without blocking; return the received commands."""
        if self._listener is not None and descriptor == self._listener.fileno():
            try:
                self.add_socket(self._listener.accept()[0])
            except OSError:
                return []
            return []
        subscriber = self._subscribers.get(descriptor)
        if subscriber is None:
            return []
        subscriber.sink.flush()
        commands, open_ = subscriber.read()
        if not open_:
            self._drop(descriptor)
        asked: list[RunCommand] = []
        for command in commands:
            if isinstance(command, Watch):
                subscriber.watch = command
            else:
                asked.append(command)
        return asked

    def flush(self) -> None:
        """Write pending data without blocking."""
        for subscriber in self._subscribers.values():
            subscriber.sink.flush()

    def close(self, limit: float) -> None:
        """Write the pending data within a time limit (s) for each subscriber, and disconnect all."""
        for descriptor, subscriber in list(self._subscribers.items()):
            subscriber.sink.finish(limit)
            self._drop(descriptor)
        if self._listener is not None:
            self._listener.close()
            self._listener = None

    def _add(self, subscriber: _Subscriber) -> int:
        self._subscribers[subscriber.descriptor] = subscriber
        for event in (*self._describe_state(), Synchronised()):
            subscriber.sink.put(dump_line(event), important=True)
        return subscriber.descriptor

    def _drop(self, descriptor: int) -> None:
        subscriber = self._subscribers.pop(descriptor)
        if self.on_removed is not None:
            self.on_removed(descriptor)
        if subscriber.link is not None:
            subscriber.link.close()


class _Subscriber:
    def __init__(self, descriptor: int, link: socket.socket | None, watch: Watch) -> None:
        self.descriptor = descriptor
        self.link = link
        self.watch = watch
        self.sink = Sink(descriptor, _describe_lost)
        self._rest = b""

    def wants(self, event: RunEvent) -> bool:
        if isinstance(event, OutputLine):
            return self.watch.output
        return self.watch.stats if isinstance(event, StatsSampled) else True

    def read(self) -> tuple[list[RunCommand], bool]:
        """Return the received commands, and whether the client is still connected."""
        if self.link is None:
            return [], True
        try:
            data = os.read(self.descriptor, 1 << 16)
        except BlockingIOError:
            return [], True
        except OSError:
            return [], False
        *lines, self._rest = (self._rest + data).split(b"\n")
        commands = []
        for line in lines:
            try:
                commands.append(parse_command(line))
            except BadLineError as problem:  # noqa: PERF203 - the other subscribers go on
                self.sink.put(dump_line(Notice("error", f"not a command: {problem}")), important=True)
        return commands, bool(data) and len(self._rest) < MOST_COMMAND_BYTES


def _describe_lost(count: int) -> bytes:
    return dump_line(Notice("warning", f"{count} lines are not shown here; the log files have them"))
