"""Notify a peer whose connection has ended on this side while the network was cut.

A subscriber that only receives does not notice that: nothing comes, and its own kernel asks after a minute or later.
RFC 793 (3.4, "Half-Open Connections and Other Anomalies") describes a way to notify it: a new request for the same
connection, from the same port, is answered as if it still existed; the answer fits nothing here, so this kernel resets
it, and the peer's program sees its end and connects again. Each request here is one packet.
"""

from __future__ import annotations

import socket
import threading
import time

LIMIT = 180.0  # s; by then the peer's own kernel has noticed: roscpp has it ask from 60 s on
PAUSE = 0.25  # s between two requests
_QUESTION = 0.25  # s for an answer

Address = tuple[str | int, ...]


def share_port(server: socket.socket) -> None:
    """Allow further sockets on the port of a listening one, which `end_half_open` needs."""
    server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)


def end_half_open(
    local: tuple[str | int, ...], peer: tuple[str | int, ...], over: threading.Event, family: int = socket.AF_INET
) -> bool:
    """Reset the peer's end of a connection that has ended here, as soon as the network allows it.

    True once the peer answers that it has no such connection. False when it never answered, or `over` was set.
    """
    end = time.monotonic() + LIMIT
    while time.monotonic() < end and not over.is_set():
        with socket.socket(family, socket.SOCK_STREAM) as question:
            question.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            share_port(question)
            question.settimeout(_QUESTION)
            try:
                question.bind(local)
                question.connect(peer)
            except ConnectionRefusedError:
                return True
            except TimeoutError:
                continue
            except OSError:
                pass  # no network at all, for now
        over.wait(PAUSE)
    return False
