"""Black boxes of a user on this computer: where their recordings are, and how they learn that something has happened.

Each listens to a datagram socket in a folder of the user; a datagram is a text for people. See ur_nodes.black_box.
"""

from collections.abc import Mapping

from ur.recordings.datagrams import send_to_all
from ur.source.user_folders import user_folder

MOST_BYTES = 1000
"""Bytes of a text."""

REPORT_REQUEST = "requested by ur report"
"""The text that has a black box write at once."""

_SOCKETS = "sockets"


def recordings_folder(environment: Mapping[str, str]) -> str:
    """Return the folder of the recordings, unless a parameter of the node names another."""
    return f"{user_folder('XDG_STATE_HOME', environment)}/ur/black_box"


def sockets_folder(environment: Mapping[str, str]) -> str:
    """Return the folder of the sockets."""
    return f"{recordings_folder(environment)}/{_SOCKETS}"


def notify_black_boxes(environment: Mapping[str, str], text: str) -> int:
    """Report an event to all black boxes; return the number of those that take it. Never waits."""
    return send_to_all(sockets_folder(environment), text.encode("utf-8", "replace")[:MOST_BYTES])


def long_recordings_folder(environment: Mapping[str, str]) -> str:
    """Return the folder of long recordings, unless the user names another."""
    return f"{user_folder('XDG_STATE_HOME', environment)}/ur/recordings"
