"""The socket at which viewers on this computer, such as the page's server, request additional nodes."""

import json
import os
import socket
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from ur.source.foreign.json_values import read_json

MODULES = ("ur_nodes.web.", "ur_nodes.assistant.")
"""The modules that may be asked for begin so."""

_MOST_SOCKETS = 4
_MOST = 4096  # bytes of a request
_LIMIT = 5.0  # s for a request


class ViewerSocket:
    """Listens at a path, and calls `run` with the words of each module that is asked for, on a thread of its own.

    The words after the module are descriptors of sockets that have come with the request.
    """

    def __init__(self, path: str, run: Callable[[Sequence[str]], None]) -> None:
        self._run = run
        self._path = Path(path)
        self._path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._path.unlink(missing_ok=True)
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._listener.bind(path)
        self._listener.listen()
        threading.Thread(target=self._serve, name="viewers", daemon=True).start()

    def close(self) -> None:
        """Stop taking requests."""
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self._path.unlink(missing_ok=True)

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            threading.Thread(target=self._attend, args=(connection,), name="viewer", daemon=True).start()

    def _attend(self, connection: socket.socket) -> None:
        """Run the requested node, and close the connection when it has ended."""
        with connection:
            connection.settimeout(_LIMIT)
            try:
                data, given, _flags, _address = socket.recv_fds(connection, _MOST, _MOST_SOCKETS)
            except OSError:
                return
            kept = [os.dup(each) for each in given]
            try:
                module = read_module(data)
                if module:
                    self._run([module, *map(str, given)])
                else:
                    for each in given:
                        os.close(each)
            finally:
                for each in kept:  # closed for the other end, also where a viewer has copied this socket
                    with socket.socket(fileno=each) as end, suppress(OSError):
                        end.shutdown(socket.SHUT_RDWR)


def read_module(data: bytes) -> str:
    """Return the module that a request names; '' if it may not run here."""
    with suppress(ValueError):
        name = read_json(data, dict[str, str], _MOST).get("module", "")
        if name.startswith(MODULES) and name.replace(".", "").replace("_", "").isalnum():
            return name
    return ""


def ask(path: str, module: str, sockets: Sequence[int]) -> socket.socket:
    """Request a node; return a connection that the host closes when the node ends. Raises OSError."""
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        connection.connect(path)
        socket.send_fds(connection, [json.dumps({"module": module}).encode()], list(sockets))
    except OSError:
        connection.close()
        raise
    return connection
