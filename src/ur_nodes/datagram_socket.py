"""A socket of a node for datagrams of programs on the same computer."""

import os
import socket
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from ur.recordings.datagrams import open_folder
from ur_nodes.ports.node import Node

_MOST_AT_ONCE = 20


class DatagramSocket:
    """Passes each datagram (at most `most` bytes) to `callback`, on the node's thread; sends back what it returns."""

    def __init__(
        self, node: Node, folder: str, period: float, most: int, callback: Callable[[bytes], bytes], without: str
    ) -> None:
        """Bind a socket in `folder`, read every `period` s; if that fails, log the effect `without` a socket."""
        self._take, self._most = callback, most
        self._path = Path(folder, str(os.getpid()))
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            self._path.unlink(missing_ok=True)
            with open_folder(folder) as place:
                self._socket.bind(f"{place}/{self._path.name}")
        except OSError as problem:
            node.log.warn(f"{self._path}: {problem.strerror or problem}: {without}")
            self._socket.close()
            return
        node.every(period, self.receive, steady=True)

    def receive(self) -> None:
        """Take the datagrams that have arrived."""
        with suppress(OSError):
            for _ in range(_MOST_AT_ONCE):
                data, sender = self._socket.recvfrom(self._most)
                answer = self._take(data)
                if answer and sender:
                    with suppress(OSError):  # a client that has ended, or that reads nothing
                        self._socket.sendto(answer, sender)

    def close(self) -> None:
        """Remove the socket."""
        with suppress(OSError):
            self._path.unlink(missing_ok=True)
        self._socket.close()
