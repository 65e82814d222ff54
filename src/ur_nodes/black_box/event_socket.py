"""The socket by which a run and `ur report` reach the black box."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ur.recordings.black_boxes import MOST_BYTES, sockets_folder
from ur.source.printable import printable
from ur_nodes.datagram_socket import DatagramSocket
from ur_nodes.ports.node import Node

_LOOK = 0.1  # s


class EventSocket:
    """Passes each received text to `happened`. Without a folder, it receives nothing."""

    def __init__(self, node: Node, environment: Mapping[str, str], happened: Callable[[str], None]) -> None:
        self._happened = happened
        without = "the end of other nodes is not noticed"
        self._socket = DatagramSocket(node, sockets_folder(environment), _LOOK, MOST_BYTES, self._take, without)

    def _take(self, data: bytes) -> bytes:
        self._happened(printable(data.decode("utf-8", "replace")).strip() or "unnamed event")
        return b""

    def close(self) -> None:
        """Handle the received texts, and remove the socket."""
        self._socket.receive()
        self._socket.close()
