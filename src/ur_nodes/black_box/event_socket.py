"""The socket by which a run and `ur report` reach the black box."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

from ur.recordings.black_boxes import MOST_BYTES, sockets_folder
from ur.source.printable import printable
from ur_nodes.ports.node import Node

_LOOK = 0.1  # s
_MOST_AT_ONCE = 20


class EventSocket:
    """Passes each text that arrives to `happened`. Without a folder nothing arrives."""

    def __init__(self, node: Node, environment: Mapping[str, str], happened: Callable[[str], None]) -> None:
        self._happened = happened
        self._path = Path(sockets_folder(environment), str(os.getpid()))
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            self._path.unlink(missing_ok=True)
            self._socket.bind(str(self._path))
        except OSError as problem:
            node.log.warn(f"{self._path}: {problem.strerror or problem}: the end of other nodes is not noticed")
            self._socket.close()
            return
        node.every(_LOOK, self.look, steady=True)

    def look(self) -> None:
        """Take what has arrived."""
        with suppress(OSError):
            for _ in range(_MOST_AT_ONCE):
                text = printable(self._socket.recv(MOST_BYTES).decode("utf-8", "replace")).strip()
                self._happened(text or "unnamed event")

    def close(self) -> None:
        """Take what has arrived, and remove the socket."""
        self.look()
        with suppress(OSError):
            self._path.unlink(missing_ok=True)
        self._socket.close()
