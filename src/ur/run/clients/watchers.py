"""Those who watch a run, over its socket or otherwise: each gets its events, none can hold the run up."""

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
MOST_BACKLOG = 20_000  # events; who does not read for so long is let go


class Watchers:
    """Everyone who watches. `descriptors` are to be polled; `attend` does what is due on one of them."""

    def __init__(self, listener: socket.socket | None, tell_state: Callable[[], Iterable[RunEvent]]) -> None:
        """Take a listening socket, and what tells a new watcher how things stand."""
        self._listener = listener
        self._tell_state = tell_state
        self._watchers: dict[int, _Watcher] = {}
        self.call_gone: Callable[[int], None] | None = None  # before a descriptor is closed

    def add_socket(self, link: socket.socket) -> int:
        """Someone who may also give commands. Returns the descriptor that identifies them."""
        link.setblocking(False)
        return self._add(_Watcher(link.fileno(), link, Watch()))

    def add_output(self, descriptor: int, watch: Watch) -> int:
        """An open file that events are written to, and that nothing is read from."""
        return self._add(_Watcher(descriptor, None, watch))

    def descriptors(self) -> dict[int, int]:
        """What to poll for, by descriptor."""
        found = {} if self._listener is None else {self._listener.fileno(): select.POLLIN}
        for descriptor, watcher in self._watchers.items():
            wanted = (select.POLLIN if watcher.link is not None else 0) | (
                select.POLLOUT if watcher.sink.waiting else 0
            )
            if wanted:
                found[descriptor] = wanted
        return found

    def watching(self, descriptor: int) -> bool:
        """Whether this one is still there."""
        return descriptor in self._watchers

    def wanted(self) -> Watch:
        """What at least one of them wants to hear."""
        watches = [watcher.watch for watcher in self._watchers.values()]
        return Watch(
            output=any(watch.output for watch in watches),
            stats=any(watch.stats for watch in watches),
            readiness=any(watch.readiness for watch in watches),
        )

    def publish(self, event: RunEvent) -> None:
        """Tell everyone who wants to know."""
        if not self._watchers:
            return
        line = b""
        for descriptor, watcher in list(self._watchers.items()):
            if not watcher.wants(event):
                continue
            line = line or dump_line(event)
            source = event.name if isinstance(event, OutputLine) else ""
            watcher.sink.put(line, important=not isinstance(event, (OutputLine, StatsSampled)), source=source)
            if watcher.sink.backlog > MOST_BACKLOG:
                self._drop(descriptor)

    def attend(self, descriptor: int) -> list[RunCommand]:
        """Accept, read and write what is possible there; returns what was asked for."""
        if self._listener is not None and descriptor == self._listener.fileno():
            try:
                self.add_socket(self._listener.accept()[0])
            except OSError:
                return []
            return []
        watcher = self._watchers.get(descriptor)
        if watcher is None:
            return []
        watcher.sink.flush()
        commands, open_ = watcher.read()
        if not open_:
            self._drop(descriptor)
        asked: list[RunCommand] = []
        for command in commands:
            if isinstance(command, Watch):
                watcher.watch = command
            else:
                asked.append(command)
        return asked

    def flush(self) -> None:
        """Write as much as is taken now."""
        for watcher in self._watchers.values():
            watcher.sink.flush()

    def close(self, limit: float) -> None:
        """Write what is left, or as much as is taken within a time limit (s) each, and let everyone go."""
        for descriptor, watcher in list(self._watchers.items()):
            watcher.sink.finish(limit)
            self._drop(descriptor)
        if self._listener is not None:
            self._listener.close()
            self._listener = None

    def _add(self, watcher: _Watcher) -> int:
        self._watchers[watcher.descriptor] = watcher
        for event in (*self._tell_state(), Synchronised()):
            watcher.sink.put(dump_line(event), important=True)
        return watcher.descriptor

    def _drop(self, descriptor: int) -> None:
        watcher = self._watchers.pop(descriptor)
        if self.call_gone is not None:
            self.call_gone(descriptor)
        if watcher.link is not None:
            watcher.link.close()


class _Watcher:
    def __init__(self, descriptor: int, link: socket.socket | None, watch: Watch) -> None:
        self.descriptor = descriptor
        self.link = link
        self.watch = watch
        self.sink = Sink(descriptor, _tell_lost)
        self._rest = b""

    def wants(self, event: RunEvent) -> bool:
        if isinstance(event, OutputLine):
            return self.watch.output
        return self.watch.stats if isinstance(event, StatsSampled) else True

    def read(self) -> tuple[list[RunCommand], bool]:
        """Commands, and whether the other end is still there."""
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
            except BadLineError as problem:  # noqa: PERF203 - the others are to be heard
                self.sink.put(dump_line(Notice("error", f"not a command: {problem}")), important=True)
        return commands, bool(data) and len(self._rest) < MOST_COMMAND_BYTES


def _tell_lost(count: int) -> bytes:
    return dump_line(Notice("warning", f"{count} lines are not shown here; the log files have them"))
