"""Run a node in the process of all nodes, for a program of this computer: viewer_program MODULE SOCKET ...

It lasts as long as the node. The SOCKETs are descriptors. Exit code 1: there is no such process.
"""

import os
import sys

from ur.system.ros import viewer_socket
from ur_nodes.one_process.viewers import ask


def main() -> int:
    """Ask for the node, and wait for its end."""
    sockets = [int(each) for each in sys.argv[2:]]
    try:
        connection = ask(viewer_socket(os.environ), sys.argv[1], sockets)
    except OSError as problem:
        sys.stderr.write(f"error: no run answers at {viewer_socket(os.environ)}: {(problem.strerror or '').lower()}\n")
        return 1
    for each in sockets:
        os.close(each)
    connection.recv(1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
