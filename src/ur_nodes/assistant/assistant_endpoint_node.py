"""The robot's end of `ur mcp`: a node that the server starts, connected to it by a socket that it inherits.

    python -I -m ur_nodes ur_nodes.assistant.assistant_endpoint_node SOCKET

SOCKET is a descriptor. The node ends when it is closed, or when another master has started.
"""

import socket
import sys

from ur_nodes.assistant.session import AssistantSession
from ur_nodes.ports.node import Node
from ur_nodes.web.server_link import Outlet, read_lines, run_for_server


def main() -> int:
    """Run until the server has ended. Returns the exit code."""
    return run_for_server("assistant", start)


def start(node: Node, connection: socket.socket) -> None:
    """Join the socket to the robot."""
    read_lines(node, {connection: AssistantSession(node, Outlet(node, connection)).handle})


if __name__ == "__main__":
    sys.exit(main())
