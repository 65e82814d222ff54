"""The socket by which `ur replay` pauses a replay that runs, changes its speed, and jumps."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

from ur.recordings.replays import MOST_BYTES, ReplayCommand, read_command, sockets_folder
from ur_nodes.ports.node import Node

_PERIOD = 0.05  # s
_MOST_AT_ONCE = 20


class ControlSocket:
    """Passes each command that arrives to `take`."""

    def __init__(self, node: Node, environment: Mapping[str, str], take: Callable[[ReplayCommand], None]) -> None:
        self._take = take
        self._path = Path(sockets_folder(environment), str(os.getpid()))
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            self._path.unlink(missing_ok=True)
            self._socket.bind(str(self._path))
        except OSError as problem:
            node.log.warn(f"{self._path}: {problem.strerror or problem}: 'ur replay --pause' and others have no effect")
            self._socket.close()
            return
        node.every(_PERIOD, self._receive, steady=True)

    def _receive(self) -> None:
        with suppress(OSError):
            for _ in range(_MOST_AT_ONCE):
                command = read_command(self._socket.recv(MOST_BYTES))
                if command is not None:
                    self._take(command)

    def close(self) -> None:
        """Remove the socket."""
        with suppress(OSError):
            self._path.unlink(missing_ok=True)
        self._socket.close()
