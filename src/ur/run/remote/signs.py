"""Signs of life of a share's clients: answers of each client's nodes, or its process that displays the run."""

import os
import threading
import time
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from enum import Enum
from pathlib import Path

from ur.run.master.client import Master, parse_master_uri
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.remote.protocol import Client
from ur.source.diagnostic import UserError

PATIENCE = 3.0  # s for all clients together; the look-up of a name that has disappeared takes 5 s
START_SECONDS = 60.0  # in which the nodes of a new client register


class Sign(Enum):
    """PRESENT: the client answers. ENDED: its computer answers that it has ended. SILENT: unknown."""

    PRESENT = "present"
    ENDED = "ended"
    SILENT = "silent"


def read_signs(clients: Iterable[Client], master: Master, now: float) -> dict[str, Sign]:
    """Read a sign of each client, by its id; `now` is in s since the epoch."""
    signs: dict[str, Sign] = {}

    def ask(client: Client) -> None:
        signs[client.client] = judge_client(client, ask_nodes(client.nodes, master), now)

    threads = []
    for client in clients:
        signs[client.client] = Sign.SILENT
        if client.detached:
            signs[client.client] = Sign.PRESENT
        elif not client.nodes:
            signs[client.client] = Sign.PRESENT if has_viewer(client.client) else Sign.SILENT
        else:
            threads.append(threading.Thread(target=ask, args=(client,), daemon=True))
            threads[-1].start()
    until = time.monotonic() + PATIENCE
    for thread in threads:
        thread.join(max(0.0, until - time.monotonic()))
    return dict(signs)


def judge_client(client: Client, nodes: Mapping[str, Sign | None], now: float) -> Sign:
    """Judge a client by its nodes; None: the master does not know a node.

    While its nodes may still start, a dead node that the master knows may be of an earlier run.
    """
    found = set(nodes.values())
    if Sign.PRESENT in found:
        return Sign.PRESENT
    if Sign.SILENT in found or now - client.since < START_SECONDS:
        return Sign.SILENT
    return Sign.ENDED


def ask_nodes(names: Iterable[str], master: Master) -> dict[str, Sign | None]:
    """Query each node that a master knows for a sign; None for nodes that it does not know."""
    names = list(names)
    try:
        found = look_up_nodes(names, master)
    except LookupError:
        return dict.fromkeys(names, Sign.SILENT)
    return {name: probe_node(found[name]) if name in found else None for name in names}


def look_up_nodes(names: Collection[str], master: Master) -> dict[str, str]:
    """Return the addresses of the nodes, of these, that a master knows. Raises LookupError without an answer."""
    try:
        found = master.call_many([("lookupNode", (name,)) for name in names]) if names else []
        pairs = list(zip(names, found, strict=True))
    except (Unanswered, CallRefused, ValueError, TypeError, LookupError) as problem:
        raise LookupError(str(problem)) from None
    return {name: uri for name, uri in pairs if isinstance(uri, str)}


def probe_node(uri: str) -> Sign:
    """Check whether a node answers at its registered address."""
    import socket

    try:
        node = parse_master_uri(uri)
        with socket.create_connection((node.host, node.port), 1.0):
            pass
        Master(uri, node.host, node.port, 1.0).call("getPid")
    except ConnectionRefusedError:
        return Sign.ENDED
    except CallRefused:
        return Sign.PRESENT
    except (Unanswered, UserError, OSError):
        return Sign.SILENT
    return Sign.PRESENT


def has_viewer(client: str, processes: str = "/proc") -> bool:
    """Return whether a process of this computer belongs to a client: it was started with that UR_CLIENT."""
    wanted = f"UR_CLIENT={client}".encode()
    for name in os.listdir(processes):  # noqa: PTH208 - numbers are enough
        if name.isdigit():
            with suppress(OSError):
                if wanted in Path(processes, name, "environ").read_bytes().split(b"\0"):
                    return True
    return False
