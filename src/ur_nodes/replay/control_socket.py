"""The socket by which `ur replay` pauses a replay that runs, changes its speed, and jumps."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ur.recordings.replays import MOST_BYTES, ReplayCommand, ReplayState, read_command, sockets_folder, write_state
from ur_nodes.datagram_socket import DatagramSocket
from ur_nodes.ports.node import Node

_PERIOD = 0.05  # s


def open_control_socket(
    node: Node, environment: Mapping[str, str], take: Callable[[ReplayCommand], ReplayState]
) -> DatagramSocket:
    """Open the socket; each command that arrives is passed to `take`, and answered with the state after it."""

    def take_datagram(data: bytes) -> bytes:
        command = read_command(data)
        return b"" if command is None else write_state(take(command))

    without = "'ur replay --pause' and others have no effect"
    return DatagramSocket(node, sockets_folder(environment), _PERIOD, MOST_BYTES, take_datagram, without)
