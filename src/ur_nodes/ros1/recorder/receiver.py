"""The thread that reads the connections of a recorder."""

import os
import select
import socket
import struct
import time
import xmlrpc.client
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import rosgraph
import rosgraph.network

from ur_nodes.loop import run_aside
from ur_nodes.ports.raw import RecordedMessage, RecordedType
from ur_nodes.ros1.repairs.sockets import CONNECT_LIMIT, is_remote, watch_peer

Address = tuple[str, int]

_HEADER_LIMIT = 5.0  # s
_MOST_HEADER = 1 << 20  # bytes
_SO_TIMESTAMPNS = 35  # Linux; Python's `socket` has no name for it


class TopicConnectionError(Exception):
    """A publisher does not let itself be recorded; the text is for logs."""


def find_publisher(caller: str, node: str, topic: str) -> Address:
    """Ask a node where it publishes its topics. Raises TopicConnectionError."""
    try:
        uri = rosgraph.Master(caller).lookupNode(node)
        with xmlrpc.client.ServerProxy(uri) as proxy:
            answer: object = proxy.requestTopic(caller, topic, [["TCPROS"]])
    except Exception as problem:  # master and node are third-party programs with any answer
        raise TopicConnectionError(f"{node}: {problem}") from None
    match answer:
        case [1, _, ["TCPROS", str(host), int(port)]]:
            return host, port
    raise TopicConnectionError(f"{node} does not publish {topic}: {answer}")


def connect_topic(caller: str, address: Address, topic: str) -> tuple[socket.socket, Mapping[str, str]]:
    """Connect to a topic of a publisher: a socket, and the header of the publisher. Raises TopicConnectionError."""
    try:
        sock = socket.create_connection(address, CONNECT_LIMIT)
    except OSError as problem:
        raise TopicConnectionError(f"{address[0]}:{address[1]}: {problem}") from None
    try:
        sock.settimeout(_HEADER_LIMIT)
        fields = {"callerid": caller, "topic": topic, "type": "*", "md5sum": "*", "tcp_nodelay": "1"}
        sock.sendall(rosgraph.network.encode_ros_handshake_header(fields))
        (size,) = _LENGTH.unpack(_receive(sock, _LENGTH.size))
        if size > _MOST_HEADER:
            raise TopicConnectionError(f"{topic}: a header of {size} bytes")
        header: Mapping[str, str] = rosgraph.network.decode_ros_handshake_header(
            _LENGTH.pack(size) + _receive(sock, size)
        )
        if "error" in header or "type" not in header:
            raise TopicConnectionError(f"{topic}: {header.get('error', 'a header without a type')}")
        if is_remote(sock):
            watch_peer(sock)
        with suppress(OSError):  # an emulated kernel has no such times
            sock.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
        sock.setblocking(False)
    except (OSError, rosgraph.network.ROSHandshakeException) as problem:
        sock.close()
        raise TopicConnectionError(f"{topic}: {problem}") from None
    except TopicConnectionError:
        sock.close()
        raise
    return sock, header


def read_stamp(messages: list[tuple[int, int, bytes]]) -> int | None:
    """The time since 1970 (ns) at which the kernel got what was received; None: it does not tell."""
    for level, kind, data in messages:
        if level == socket.SOL_SOCKET and kind == _SO_TIMESTAMPNS and len(data) == 16:
            seconds, rest = struct.unpack("=qq", data)
            return int(seconds) * 1_000_000_000 + int(rest)
    return None


def _receive(sock: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        part = sock.recv(size - len(data))
        if not part:
            raise TopicConnectionError("the publisher has closed the connection")
        data += part
    return data


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
