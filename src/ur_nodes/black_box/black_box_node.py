"""The node `black_box`: keeps two minutes of all topics in memory, and writes them to a file after an event."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from ur.recordings.black_boxes import recordings_folder
from ur_nodes.black_box.black_box import BlackBox, BlackBoxSettings
from ur_nodes.black_box.event_socket import EventSocket
from ur_nodes.black_box.guard import GuardProcess
from ur_nodes.black_box.ring import Ring
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.run import run


def read_settings(parameters: Parameters) -> tuple[BlackBoxSettings, int]:
    """Read the settings, and the size of the memory in bytes."""
    folder = parameters.text("~folder", "") or recordings_folder(os.environ)
    settings = BlackBoxSettings(
        Path(folder).expanduser(),
        parameters.integer("~kept", 10, minimum=1),
        parameters.number("~seconds", 120.0, minimum=1.0),
        parameters.number("~after", 5.0, minimum=0.0),
        parameters.text("~mux", "cmd_vel_mux"),
        parameters.text("~navigation", "move_base"),
        parameters.text("~localiser", "amcl"),
        parameters.boolean("~cameras", True),
    )
    return settings, int(parameters.number("~megabytes", 20.0, minimum=1.0) * 1e6)


def start(node: Node) -> BlackBox:
    """Start the guard, and record."""
    settings, size = read_settings(node.parameters)
    guard = GuardProcess(size, settings.folder, settings.kept)
    socket = EventSocket(node, os.environ, lambda text: box.happened(text))
    node.on_end(socket.close)  # before the black box ends, which writes what has happened last
    box = BlackBox(node, settings, Ring(memoryview(guard.block)))
    node.on_end(guard.end)
    return box


def main() -> int:
    """Run the node until it ends."""
    return run("black_box", start)


if __name__ == "__main__":
    sys.exit(main())
