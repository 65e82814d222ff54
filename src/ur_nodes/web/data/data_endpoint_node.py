"""Reads data of the robot for pages: a node that the server starts, connected to it by a socket that it inherits.

    python -I -m ur_nodes ur_nodes.web.data.data_endpoint_node LINK

LINK is a descriptor. Requests of pages arrive as lines, frames (`ur.web.wire.data_requests`) leave. All that a topic
holds is decoded here and not where the robot is driven from. The node ends when LINK is closed, or when another master
has started.
"""

import socket
import sys

from ur_nodes.ports.node import Node
from ur_nodes.web.data.data_endpoint import DataSession
from ur_nodes.web.server_link import Outlet, read_lines, run_for_server


def main() -> int:
    """Run until the server has ended. Returns the exit code."""
    return run_for_server("web_data", start)


def start(node: Node, link: socket.socket) -> None:
    """Connect the socket to the data that pages show and to their requests."""
    read_lines(node, {link: DataSession(node, Outlet(node, link)).receive})


if __name__ == "__main__":
    sys.exit(main())
