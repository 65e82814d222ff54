"""Connections to publishers of ROS 1, for recorders. The master does not know of them."""

from __future__ import annotations

import socket
import struct
import xmlrpc.client
from collections.abc import Mapping

import rosgraph
import rosgraph.network

from ur_nodes.ros1.repairs.sockets import CONNECT_LIMIT, is_remote, watch_peer

Address = tuple[str, int]

_HEADER_LIMIT = 5.0  # s
_MOST_HEADER = 1 << 20  # bytes
_SO_TIMESTAMPNS = 35  # Linux; Python's `socket` has no name for it
_LENGTH = struct.Struct("<I")


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
