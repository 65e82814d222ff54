"""Control of a run from outside: over its socket, or over one end of a socket pair inside `ur launch`."""

from __future__ import annotations

import os
import select
import socket
import time
from collections.abc import Iterator
from typing import Protocol

from ur.run.clients.protocol import BadLineError, RunCommand, RunEnded, RunEvent, dump_line, parse_event


class RunControl(Protocol):
    """A run as a client sees it. `fileno` is readable when `receive` has events."""

    def fileno(self) -> int:
        """Return the descriptor for select, poll and event loops."""

    def receive(self) -> list[RunEvent] | None:
        """Return events since the last call, without blocking; None once the run has ended or its socket has closed."""

    def send(self, command: RunCommand) -> None:
        """Send a command; no effect once the run has ended."""

    def close(self) -> None:
        """Disconnect; the run continues."""


class RunUnreachable(Exception):  # noqa: N818 - says what happened
    """The run has ended, or its supervisor was killed."""


class RunClient:
    """`RunControl` over a connected stream socket. Made by `connect_run`, or around one end of a pair."""

    def __init__(self, link: socket.socket) -> None:
        self._link = link
        self._rest = b""
        self._over = False
        link.setblocking(False)

    def fileno(self) -> int:
        """Return the descriptor for select, poll and event loops."""
        return self._link.fileno()

    def receive(self) -> list[RunEvent] | None:
        """Return events since the last call, without blocking; None once the run has ended or its socket has closed."""
        if self._over:
            return None
        data = b""
        try:
            while len(data) < 1 << 20 and (part := self._link.recv(1 << 16)):
                data += part
            self._over = len(data) < 1 << 20
        except BlockingIOError:
            pass
        except OSError:
            self._over = True
        *lines, self._rest = (self._rest + data).split(b"\n")
        events: list[RunEvent] = []
        for line in lines:
            try:
                events.append(parse_event(line))
            except BadLineError:  # noqa: PERF203 - an event of a newer version
                continue
        return None if self._over and not events else events

    def send(self, command: RunCommand) -> None:
        """Send a command; no effect once the run has ended."""
        try:
            self._link.setblocking(True)
            self._link.sendall(dump_line(command))
        except OSError:
            return
        finally:
            self._link.setblocking(False)

    def close(self) -> None:
        """Disconnect; the run continues."""
        self._link.close()

    def __enter__(self) -> RunClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def connect_run(folder: str) -> RunClient:
    """Connect to the run with this control folder (see `ur.run.record.registry`). Raises RunUnreachable."""
    link = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        place = os.open(folder, os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            link.connect(f"/proc/self/fd/{place}/control")  # a socket's address holds 107 bytes only, unix(7)
        finally:
            os.close(place)
    except OSError as problem:
        link.close()
        raise RunUnreachable(f"{folder}: {(problem.strerror or str(problem)).lower()}") from None
    return RunClient(link)


def iterate_events(control: RunControl, timeout: float | None = None) -> Iterator[RunEvent]:
    """Yield every event until the run ends, or until no event arrives for `timeout` s."""
    while True:
        deadline = None if timeout is None else time.monotonic() + timeout
        while not select.select([control], [], [], None if deadline is None else deadline - time.monotonic())[0]:
            if deadline is not None and time.monotonic() >= deadline:
                return
        events = control.receive()
        if events is None:
            return
        for event in events:
            yield event
            if isinstance(event, RunEnded):
                return
