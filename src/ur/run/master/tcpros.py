"""Subscription to a topic without a ROS library (http://wiki.ros.org/ROS/TCPROS), to detect that messages arrive.

Nothing is registered with the master: the publisher is contacted directly, so the graph shows no additional subscriber.
"""

import socket
import struct
from urllib.parse import urlsplit

from ur.run.master.xml_rpc import CallRefused, Unanswered, call_method

LONGEST_MESSAGE = 256 << 20  # bytes; anything larger is not a message


class NoTopic(Exception):  # noqa: N818 - says what happened
    """The publisher does not answer, or does not have the topic."""


class TopicConnection:
    """A connection to one publisher of one topic. `keep` is the number of bytes of each message that are stored."""

    def __init__(self, link: socket.socket, keep: int) -> None:
        self._link = link
        self._keep = keep
        self._data = bytearray()
        self._skip = 0
        self._header = True
        link.setblocking(False)

    def fileno(self) -> int:
        """Return the descriptor for select."""
        return self._link.fileno()

    def receive(self) -> list[bytes]:
        """Return the beginnings of the messages that have arrived. Raises NoTopic if the connection has closed."""
        try:
            part = self._link.recv(1 << 18)
        except BlockingIOError:
            return []
        except OSError as problem:
            raise NoTopic(str(problem)) from None
        if not part:
            raise NoTopic("the publisher closed the connection")
        messages: list[bytes] = []
        self._data += part
        while True:
            dropped = min(self._skip, len(self._data))
            del self._data[:dropped]
            self._skip -= dropped
            if self._skip or len(self._data) < 4:
                return messages
            size = int.from_bytes(self._data[:4], "little")
            if size > LONGEST_MESSAGE:
                raise NoTopic(f"a message of {size} bytes")
            wanted = size if self._header else min(size, self._keep)
            if len(self._data) < 4 + wanted:
                return messages
            body = bytes(self._data[4 : 4 + wanted])
            del self._data[: 4 + wanted]
            self._skip = size - wanted
            if self._header:
                self._header = False
                if b"error=" in body:
                    raise NoTopic(body.partition(b"error=")[2].decode("utf-8", "replace"))
            else:
                messages.append(body)

    def close(self) -> None:
        """Close the connection."""
        self._link.close()


def listen_to(node_uri: str, topic: str, *, keep: int, timeout: float, caller: str) -> TopicConnection:
    """Connect to a publisher by its XML-RPC address. Raises NoTopic."""
    try:
        where = urlsplit(node_uri)
        host, port = where.hostname or "", where.port or 0
        answer = call_method((host, port), "requestTopic", [caller, topic, [["TCPROS"]]], timeout)
        code, message, choice = answer
        if code != 1:
            raise NoTopic(str(message))
        _, address, topic_port = choice
        link = socket.create_connection((address, topic_port), timeout)
    except (Unanswered, CallRefused, OSError, ValueError, TypeError) as problem:
        raise NoTopic(str(problem)) from None
    fields = (f"callerid={caller}", "md5sum=*", "type=*", f"topic={topic}", "tcp_nodelay=1")
    header = b"".join(struct.pack("<I", len(field.encode())) + field.encode() for field in fields)
    try:
        link.sendall(struct.pack("<I", len(header)) + header)
    except OSError as problem:
        link.close()
        raise NoTopic(str(problem)) from None
    return TopicConnection(link, keep)


def read_frames(message: bytes) -> set[str]:
    """Return the frames in a tf2_msgs/TFMessage, parents and children, without leading slashes."""
    frames: set[str] = set()
    try:
        (count,) = struct.unpack_from("<I", message)
        offset = 4
        for _ in range(count):
            offset += 12  # seq, stamp
            for _ in range(2):
                (size,) = struct.unpack_from("<I", message, offset)
                frames.add(message[offset + 4 : offset + 4 + size].decode("utf-8", "replace").lstrip("/"))
                offset += 4 + size
            offset += 56  # translation and rotation: seven float64
    except struct.error:
        return frames
    return frames
