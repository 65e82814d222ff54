"""Datagrams to programs of a user on this computer, each of which has a socket in one folder."""

from __future__ import annotations

import os
import socket
from contextlib import suppress


def send_to_all(folder: str, data: bytes) -> int:
    """Send a datagram to all sockets of a folder; return the number of those that take it. Never waits."""
    try:
        names = os.listdir(folder)  # noqa: PTH208 - pathlib is not worth its import here
    except OSError:
        return 0
    taken = 0
    for name in names:
        path = f"{folder}/{name}"
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            sender.setblocking(False)
            try:
                sender.sendto(data, path)
                taken += 1
            except ConnectionRefusedError:  # its node was killed
                with suppress(OSError):
                    os.unlink(path)  # noqa: PTH108 - likewise
            except OSError:
                pass  # it ends, or has more waiting than it takes
    return taken
