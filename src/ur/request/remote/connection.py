"""Connections to the robot of a command: the named ROBOT, else the selected one."""

import os
from collections.abc import Sequence
from contextlib import AbstractContextManager, suppress
from urllib.parse import urlsplit

from ur.request.environment import current_selection
from ur.robot.discovery.record import find_user, records_folder
from ur.robot.doctor.inspect import RegisteredNode
from ur.robot.ssh.address import Address, parse_address
from ur.robot.ssh.openssh import SshShell, connect
from ur.robot.ssh.secret import Secret
from ur.run.master.xml_rpc import CallRefused, Unanswered, call_method
from ur.source.diagnostic import user_error
from ur.source.progress_line import show_progress


def connect_robot(
    address: Address, *, password: Secret | None = None, options: Sequence[str] = ()
) -> AbstractContextManager[SshShell]:
    """Log in as `ur.robot.ssh.openssh.connect` does; the terminal shows the robot that is waited for."""
    return connect(address, password=password, options=options, waiting=show_progress)


def robot_address(robot: str | None) -> Address:
    """Return the address of ROBOT on a command line. Raises UserError if none is given and none is selected."""
    if robot is None:
        selected = current_selection(os.environ)
        if selected.simulated:
            raise user_error(
                "no robot given, and the selected robot is simulated, expected a real robot",
                rule="no-robot",
                help="name a robot, or select one with 'ur use ROBOT'; 'ur robots' lists them",
            )
        robot = selected.robot
    name = robot.rpartition("@")[2].removesuffix(".local")
    return parse_address(robot, find_user(name, records_folder(os.environ)))


MASTER_PORT = 11311
_FAILURES = (CallRefused, Unanswered, OSError, ValueError, TypeError, IndexError)


def list_node_names(host: str, timeout: float) -> list[str] | None:
    """Return the nodes that the master at an address knows; None if no master answers."""
    try:
        _, _, state = call_method((host, MASTER_PORT), "getSystemState", ["/ur"], timeout)
        return sorted({node for group in state for _, nodes in group for node in nodes})
    except _FAILURES:
        return None


def list_nodes(host: str) -> list[RegisteredNode]:
    """Return the nodes, with the host and port of each address; empty if no master answers."""
    found = []
    for name in list_node_names(host, 2.0) or ():
        with suppress(*_FAILURES):  # it ended in the meantime
            address = urlsplit(str(call_method((host, MASTER_PORT), "lookupNode", ["/ur", name], 2.0)[2]))
            found.append(RegisteredNode(name, address.hostname or "", address.port or 0))
    return found
