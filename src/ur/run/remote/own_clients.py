"""Clients on this computer: each holds a locked file until its process ends for any reason."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ur.run.record.entry import runs_folders


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
