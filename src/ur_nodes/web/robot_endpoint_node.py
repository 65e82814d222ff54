"""The robot's end of the page: a node that the server starts, connected to it by two sockets that it inherits.

    python -I -m ur_nodes ur_nodes.web.robot_endpoint_node VIEW DRIVE

VIEW and DRIVE are descriptors. Frames leave by VIEW; requests of pages, and the answers to them, have DRIVE of their
own, so that they never wait behind a map. The node ends when either is closed, or when another master has started.
"""

import socket
import sys

from ur_nodes.ports.node import Node
from ur_nodes.web.robot_endpoint import RobotSession
from ur_nodes.web.server_link import Outlet, read_lines, run_for_server


def main() -> int:
    """Run until the server has ended. Returns the exit code."""
    return run_for_server("web", start)


def start(node: Node, view: socket.socket, drive: socket.socket) -> None:
    """Connect the sockets to the robot."""
    end = RobotSession(node, Outlet(node, view), Outlet(node, drive))
    read_lines(node, {view: end.on_view, drive: end.on_drive})


if __name__ == "__main__":
    sys.exit(main())
