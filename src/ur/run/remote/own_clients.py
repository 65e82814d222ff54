"""Clients on this computer: each holds a locked file until its process ends for any reason."""

import fcntl
import os
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ur.run.record.registry import runs_folders
from ur.run.remote.protocol import Client, parse_client
from ur.source.foreign.json_values import read_json, write_json
from ur.source.replace import PRIVATE, replace_file


@contextmanager
def hold_client(identity: str, folder: Path) -> Iterator[None]:
    """Register a client with this id, which `list_clients` finds until the context or the process ends."""
    path = folder / identity
    try:
        lock = _lock_file(path)
    except OSError:  # a full disk: other runs of this computer consider the client ended
        yield
        return
    try:
        yield
    finally:
        with suppress(OSError):
            path.unlink()
        os.close(lock)


def list_clients(folder: Path) -> list[str]:
    """Return the ids of the clients that run on this computer. Files of killed clients are removed."""
    found = []
    with suppress(OSError):
        for path in sorted(folder.iterdir()):
            with suppress(OSError):
                lock = os.open(path, os.O_RDWR | os.O_CLOEXEC)
                try:
                    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    path.unlink()
                except BlockingIOError:
                    found.append(path.name)
                finally:
                    os.close(lock)
    return found


def clients_folder(environment: Mapping[str, str], uid: int) -> Path:
    """Return the folder of a user's client files."""
    return Path(runs_folders(environment, uid)[0]).parent / "clients"


def _lock_file(path: Path) -> int:
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    while True:
        lock = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if path.stat().st_ino == os.fstat(lock).st_ino:
                return lock
        except FileNotFoundError:  # another process listed it before it was locked, and has removed it
            pass
        except OSError:
            os.close(lock)
            raise
        os.close(lock)


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
