"""A lock per master: one launch at a time lists the nodes that are running and registers its run."""

import fcntl
import os
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ur.run.master.client import parse_master_uri
from ur.run.paths import is_local_address
from ur.run.record.registry import runs_folders
from ur.system.ros import read_domain

_PERIOD = 0.05  # s
_PATIENCE = 2.0  # s of waiting, after which the wait is reported


class MasterLock:
    """A lock that is held from its creation until `release`, or until this process ends."""

    def __init__(self, descriptor: int = -1) -> None:
        self._descriptor = descriptor

    def release(self) -> None:
        """Release the lock. A second release has no effect."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1


@contextmanager
def lock_master(
    master_uri: str, environment: Mapping[str, str], uid: int, report: Callable[[str], None]
) -> Iterator[MasterLock]:
    """Hold the lock against other launches of this user at a master while the context lasts.

    `report` gets one line about a long wait. If no lock file can be created, nothing is locked.
    """
    lock = MasterLock(_acquire(master_uri, environment, uid, report))
    try:
        yield lock
    finally:
        lock.release()


def _acquire(master_uri: str, environment: Mapping[str, str], uid: int, report: Callable[[str], None]) -> int:
    path = Path(runs_folders(environment, uid)[0]).parent / "masters" / f"{_name(master_uri)}.lock"
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    except OSError:  # a full disk
        return -1
    began: float | None = time.monotonic()
    try:
        while not try_lock(descriptor):
            if began is not None and time.monotonic() > began + _PATIENCE:
                holder = os.pread(descriptor, 20, 0).decode("ascii", "replace").strip() or "unknown"
                report(f"waiting for another launch at {master_uri} to start (process {holder})")
                began = None
            time.sleep(_PERIOD)
        with suppress(OSError):  # a full disk
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, str(os.getpid()).encode(), 0)
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor


def _name(master_uri: str) -> str:
    domain = read_domain(master_uri)
    if domain is not None:
        return f"ros2_{domain}"
    master = parse_master_uri(master_uri)
    host = "localhost" if is_local_address(master.host) else master.host
    safe = "".join(letter if letter.isalnum() or letter in ".-" else "_" for letter in host)[:100]
    return f"{safe}_{master.port}"


def try_lock(descriptor: int) -> bool:
    """Lock an open file if no other process holds it."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
