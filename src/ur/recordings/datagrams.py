"""Datagrams to programs of a user on this computer, each of which has a socket in one folder."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress


@contextmanager
def open_folder(folder: str) -> Iterator[str]:
    """Another path of a folder, for the addresses of sockets in it: they have at most 107 bytes. Raises OSError."""
    descriptor = os.open(folder, os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        yield f"/proc/self/fd/{descriptor}"
    finally:
        os.close(descriptor)


def send_to_all(folder: str, data: bytes, sender: socket.socket | None = None) -> int:
    """Send a datagram to all sockets of a folder; return the number of those that take it. Never waits.

    They answer to `sender`, where there is one.
    """
    try:
        with open_folder(folder) as place:
            names = os.listdir(place)  # noqa: PTH208 - starts faster
            if sender is not None:
                return sum(_send(f"{place}/{name}", data, sender) for name in names)
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as own:
                return sum(_send(f"{place}/{name}", data, own) for name in names)
    except OSError:
        return 0


def _send(path: str, data: bytes, sender: socket.socket) -> bool:
    """Send to a socket; return whether it takes the datagram."""
    try:
        sender.sendto(data, socket.MSG_DONTWAIT, path)
    except ConnectionRefusedError:  # its node was killed
        with suppress(OSError):
            os.unlink(path)  # noqa: PTH108 - pathlib is not worth its import here
        return False
    except OSError:
        return False  # it ends, or has more waiting than it takes
    return True
