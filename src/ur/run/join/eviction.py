"""Evictions: a ROS master ends a node when another node registers under its name."""

from __future__ import annotations

import os

from ur.run.master.client import Master, parse_master_uri
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.paths import is_local_address
from ur.run.record.computer import read_computer
from ur.run.record.registry import list_runs
from ur.run.supervisor.events import Event, Evicted, Exited
from ur.source.diagnostic import UserError

_PATIENCE = 5.0  # s; a busy computer answers late, and a port without a listener refuses at once
_MAX_DEPTH = 64


def examine_exit(event: Exited, master: Master) -> Event:
    """Return Evicted in place of Exited if a process of another run answers under the node's name."""
    try:
        asked = Master(master.uri, master.host, master.port, _PATIENCE)
        node = parse_master_uri(str(asked.call("lookupNode", event.name)))
        pid = int(Master(node.uri, node.host, node.port, _PATIENCE).call("getPid"))
    except (Unanswered, CallRefused, UserError, ValueError, TypeError):
        return event
    if not is_local_address(node.host):
        return Evicted(event.name, event.status, f"process {pid} on {node.host}")
    ancestors = _list_ancestors(pid)
    if os.getpid() in ancestors:
        return event
    runs = list_runs(os.environ, os.getuid(), read_computer())
    run = next((each.run for each in runs if each.pid in ancestors), "")
    return Evicted(event.name, event.status, f"run {run}" if run else f"process {pid}")


def _list_ancestors(pid: int) -> list[int]:
    found: list[int] = []
    while pid > 1 and len(found) < _MAX_DEPTH:
        found.append(pid)
        try:
            with open(f"/proc/{pid}/stat", "rb") as file:  # noqa: PTH123 - as in ur.run.record.registry
                pid = int(file.read().rpartition(b")")[2].split()[1])
        except (OSError, ValueError, IndexError):
            break
    return found
