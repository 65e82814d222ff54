"""Clients of a robot's share of a run, registered in the control folder of that run.

The list is changed while `ur.run.remote.local_runs.lock_shares` is held, and replaced as a whole.
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from ur.run.remote.protocol import Client, parse_client
from ur.source.foreign.json_values import read_json, write_json
from ur.source.replace import PRIVATE, replace_file

MAX_CLIENTS = 32
_FILE = "clients.json"


class TooManyClientsError(Exception):
    """No more clients can be registered."""


def add_client(clients: Collection[Client], client: Client) -> tuple[Client, ...]:
    """Register a client. It replaces its own entry and detached ones of its computer.

    Raises TooManyClientsError.
    """
    others = tuple(
        each
        for each in clients
        if each.client != client.client and not (each.detached and each.machine == client.machine)
    )
    if len(others) >= MAX_CLIENTS:
        raise TooManyClientsError
    return (*others, client)


def remove_clients(clients: Collection[Client], identities: Collection[str]) -> tuple[Client, ...]:
    """Remove the clients with these ids."""
    return tuple(each for each in clients if each.client not in identities)


def remove_dead(clients: Collection[Client], machine: str, alive: Collection[str]) -> tuple[Client, ...]:
    """Remove the clients of a computer that ended without unregistering: those that are not among its `alive` ones."""
    return tuple(each for each in clients if each.machine != machine or each.detached or each.client in alive)


def is_shared(folder: str) -> bool:
    """Return whether clients are registered with the run of this control folder."""
    return Path(folder, _FILE).is_file()


def read_clients(folder: str) -> tuple[Client, ...]:
    """The clients of the run with this control folder, oldest first."""
    try:
        return tuple(map(parse_client, read_json(Path(folder, _FILE).read_bytes(), list)))
    except (OSError, ValueError):
        return ()


def write_clients(folder: str, clients: Collection[Client]) -> None:
    """Replace the clients of a run atomically. Raises OSError: the run has ended, or the disk is full."""
    replace_file(Path(folder, _FILE), write_json(tuple(clients)), mode=PRIVATE, lasting=False)
