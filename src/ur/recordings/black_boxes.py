"""Black boxes of a user on this computer: where their recordings are, and how they learn that something has happened.

Each listens to a datagram socket in a folder of the user; a datagram is a text for people. See ur_nodes.black_box.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Mapping
from contextlib import suppress

from ur.source.user_folders import user_folder

MOST_BYTES = 1000
"""Bytes of a text."""

REPORT_REQUEST = "requested by ur report"
"""The text that has a black box write at once."""

_SOCKETS = "sockets"


def recordings_folder(environment: Mapping[str, str]) -> str:
    """The folder of the recordings, unless a parameter of the node names another."""
    return f"{user_folder('XDG_STATE_HOME', environment)}/ur/black_box"


def sockets_folder(environment: Mapping[str, str]) -> str:
    """The folder of the sockets."""
    return f"{recordings_folder(environment)}/{_SOCKETS}"


def notify_black_boxes(environment: Mapping[str, str], text: str) -> int:
    """Report to all black boxes that something has happened; the number of those that take it. Never waits."""
    folder = sockets_folder(environment)
    try:
        names = os.listdir(folder)  # noqa: PTH208 - pathlib is not worth its import here
    except OSError:
        return 0
    taken = 0
    data = text.encode("utf-8", "replace")[:MOST_BYTES]
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


def long_recordings_folder(environment: Mapping[str, str]) -> str:
    """The folder of long recordings, unless the user names another."""
    return f"{user_folder('XDG_STATE_HOME', environment)}/ur/recordings"
