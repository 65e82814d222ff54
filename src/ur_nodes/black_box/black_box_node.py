"""The node `black_box`: keeps two minutes of all topics in memory, and writes them to a file after an event."""

import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from ur.recordings.black_boxes import MOST_BYTES, recordings_folder, sockets_folder
from ur.source.printable import printable
from ur_nodes.black_box.black_box import BlackBox, BlackBoxSettings
from ur_nodes.black_box.guard import GuardedMemory
from ur_nodes.black_box.history import Ring
from ur_nodes.datagram_socket import DatagramSocket
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.run import run

_LOOK = 0.1  # s


class EventSocket:
    """Passes each received text to `happened`. Without a folder, it receives nothing."""

    def __init__(self, node: Node, environment: Mapping[str, str], happened: Callable[[str], None]) -> None:
        self._happened = happened
        without = "the end of other nodes is not noticed"
        self._socket = DatagramSocket(node, sockets_folder(environment), _LOOK, MOST_BYTES, self._on_data, without)

    def _on_data(self, data: bytes) -> bytes:
        self._happened(printable(data.decode("utf-8", "replace")).strip() or "unnamed event")
        return b""

    def close(self) -> None:
        """Handle the received texts, and remove the socket."""
        self._socket.receive()
        self._socket.close()


def read_settings(parameters: Parameters) -> BlackBoxSettings:
    """Read the settings of the recording."""
    return BlackBoxSettings(
        parameters.number("seconds", 120.0, minimum=1.0),
        parameters.number("after", 5.0, minimum=0.0),
        parameters.text("mux", "cmd_vel_mux"),
        parameters.text("navigation", "move_base"),
        parameters.text("localiser", "amcl"),
        parameters.boolean("cameras", True),
    )


def share_memory(parameters: Parameters) -> GuardedMemory:
    """Start the guard of a memory; its files are in `~folder`, of which the newest `~kept` stay."""
    folder = parameters.text("folder", "") or recordings_folder(os.environ)
    size = int(parameters.number("megabytes", 20.0, minimum=1.0) * 1e6)
    return GuardedMemory(size, Path(folder).expanduser(), parameters.integer("kept", 10, minimum=1))


def start(node: Node) -> BlackBox:
    """Start the guard, and record."""
    settings = read_settings(node.parameters)
    memory = share_memory(node.parameters)
    socket = EventSocket(node, os.environ, lambda text: box.happened(text))
    node.on_end(socket.close)  # before the black box ends, which writes what has happened last
    box = BlackBox(node, settings, Ring(memoryview(memory.block)), memory.write)
    node.on_end(memory.end)
    return box


def main() -> int:
    """Run the node until it ends."""
    return run("black_box", start)


if __name__ == "__main__":
    sys.exit(main())
