"""The nodes that a ROS master knows, read without ROS."""

from __future__ import annotations

from contextlib import suppress
from urllib.parse import urlsplit

from ur.robot.doctor.inspect import RegisteredNode
from ur.run.master.xml_rpc import CallRefused, Unanswered, call_method

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
