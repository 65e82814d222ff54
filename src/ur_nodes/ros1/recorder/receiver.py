"""The thread that reads the connections of a recorder."""

from __future__ import annotations

import os
import select
import socket
import struct
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from ur_nodes.loop import run_aside
from ur_nodes.ports.raw import RecordedMessage, RecordedType
from ur_nodes.ros1.recorder.topic_connection import read_stamp

MOST_BYTES = 1 << 26
"""Bytes of one message."""

_LENGTH = struct.Struct("<I")


class FrameError(Exception):
    """The stream is none of messages."""


class Frames:
    """Cuts a stream into messages; what is incomplete waits for the rest."""

    def __init__(self) -> None:
        self._rest = bytearray()

    def feed(self, data: memoryview) -> list[bytes]:
        """The messages that are complete now. Raises FrameError."""
        if self._rest:
            self._rest += data
            with memoryview(self._rest) as whole:
                found, used = _cut(whole)
            del self._rest[:used]
            return found
        found, used = _cut(data)
        if used < len(data):
            self._rest += data[used:]
        return found


def _cut(data: memoryview) -> tuple[list[bytes], int]:
    found: list[bytes] = []
    place = 0
    while len(data) - place >= _LENGTH.size:
        (length,) = _LENGTH.unpack_from(data, place)
        if length > MOST_BYTES:
            raise FrameError(f"a message of {length} bytes, expected at most {MOST_BYTES}")
        end = place + _LENGTH.size + length
        if end > len(data):
            break
        found.append(bytes(data[place + _LENGTH.size : end]))
        place = end
    return found, place


PAUSE = 0.04  # s between two readings, in which the kernel keeps what arrives
_BUFFER = 1 << 20
_MOST_BEHIND = 1_000_000_000  # ns that a message waits at most: more means that the computer's clock was set
_AT_ONCE = struct.pack("ii", 1, 0)


@dataclass(slots=True, eq=False)
class TopicLink:
    """A connection; one that is taken `once` ends with its first message. `end` is called once, on any thread."""

    socket: socket.socket
    type: RecordedType
    once: bool
    end: Callable[[], None]
    frames: Frames = field(default_factory=Frames)
    unwanted: bool = False


class LinkReceiver:
    """Reads links, and gives what arrives to `callback`, on a thread of its own, from the first link to `close`."""

    def __init__(self, callback: Callable[[Sequence[RecordedMessage]], None], clock: Callable[[], int]) -> None:
        self._take, self._clock = callback, clock
        self._new: deque[TopicLink | None] = deque()
        self._links: dict[int, TopicLink] = {}
        self._buffer = memoryview(bytearray(_BUFFER))
        self._wake_read, self._wake = os.pipe()
        self._poll = select.epoll()
        self._poll.register(self._wake_read, select.EPOLLIN)
        run_aside(self._run)

    def add(self, link: TopicLink) -> None:
        """Read from a link. May come from any thread."""
        self._new.append(link)
        os.write(self._wake, b"+")

    def drop(self, link: TopicLink) -> None:
        """End a link."""
        link.unwanted = True
        self.add(link)

    def close(self) -> None:
        """End all links and the thread."""
        self._new.append(None)
        os.write(self._wake, b"-")

    def _run(self) -> None:
        while True:
            batch: list[RecordedMessage] = []
            more = False
            for number, _ in self._poll.poll():
                link = self._links.get(number)
                if link is not None:
                    more |= self._read(link, batch)
                elif number == self._wake_read and not self._on_new():
                    return
            if batch:
                self._take(batch)
            if not more:
                time.sleep(PAUSE)

    def _on_new(self) -> bool:
        os.read(self._wake_read, 4096)
        with suppress(IndexError):
            while True:
                link = self._new.popleft()
                if link is None:
                    for each in tuple(self._links.values()):
                        self._end(each)
                    return False
                number = link.socket.fileno()  # -1: it has ended
                if not link.unwanted:
                    self._links[number] = link
                    self._poll.register(number, select.EPOLLIN)
                elif number in self._links:
                    self._end(link)
        return True

    def _read(self, link: TopicLink, batch: list[RecordedMessage]) -> bool:
        """Read what a link has; return whether there may be more."""
        try:
            size, extra, _, _ = link.socket.recvmsg_into([self._buffer], 64)
            if not size:
                raise ConnectionResetError
            found = link.frames.feed(self._buffer[:size])
        except BlockingIOError:
            return False
        except (OSError, FrameError):
            self._end(link)
            return False
        if not found:
            return size == _BUFFER
        now = self._clock()
        stamp = read_stamp(extra)
        behind = 0 if stamp is None else time.time_ns() - stamp
        if 0 < behind < _MOST_BEHIND:
            now -= behind
        if link.once:
            batch.append(RecordedMessage(link.type, now, found[0]))
            self._end(link)
            return False
        batch.extend(RecordedMessage(link.type, now, each) for each in found)
        return size == _BUFFER

    def _end(self, link: TopicLink) -> None:
        number = link.socket.fileno()
        del self._links[number]
        self._poll.unregister(number)
        with suppress(OSError):  # so that the publisher notices it with its next message, not the one after that
            link.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE)
        link.socket.close()
        link.end()
