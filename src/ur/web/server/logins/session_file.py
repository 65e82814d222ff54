"""The file of a server's sessions; another process may remove entries while the server runs, which ends them."""

import fcntl
import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ur.source.replace import PRIVATE, replace_file
from ur.source.user_folders import user_folder
from ur.web.access.roles import Ledger, end_sessions, read_sessions, session_id, write_sessions

_LONGEST = 1 << 20  # bytes


def state_folder() -> Path:
    """Return the folder of sessions and log."""
    return Path(user_folder("XDG_STATE_HOME", os.environ), "ubiquity_launches", "web")


class SessionFile:
    """The sessions of one server, in a file that only the user can read, so that they survive a restart."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._stored: frozenset[str] = frozenset()
        self._seen: tuple[int, int, int] | None = None

    def load(self) -> Ledger:
        """Read the file; a missing or malformed one has no sessions."""
        self._seen = self._look()
        ledger = self._read()
        self._stored = frozenset(map(session_id, ledger.sessions))
        return ledger

    def store(self, ledger: Ledger, *, lasting: bool = True) -> Ledger:
        """Write the sessions except those that another process has ended, and return the remaining ones.

        Raises OSError.
        """
        with self._lock():
            ledger = end_sessions(ledger, self._list_ended())
            replace_file(self._path, write_sessions(ledger), mode=PRIVATE, parents=True, lasting=lasting)
            self._stored = frozenset(map(session_id, ledger.sessions))
            self._seen = self._look()
        return ledger

    def list_ended(self) -> Collection[str]:
        """List the ids of the sessions that another process has ended since the file was read or written."""
        return self._list_ended() if self._look() != self._seen else ()

    def read(self) -> Ledger:
        """Read the file in a process other than the server."""
        return self._read()

    def end(self, ids: Collection[str]) -> None:
        """Remove sessions from the file, which the server notices. Raises OSError."""
        with self._lock():
            replace_file(self._path, write_sessions(end_sessions(self._read(), ids)), mode=PRIVATE)

    def _list_ended(self) -> Collection[str]:
        self._seen = self._look()
        return self._stored - set(map(session_id, self._read().sessions))

    def _read(self) -> Ledger:
        with suppress(OSError, UnicodeDecodeError), self._path.open("rb") as file:
            return read_sessions(file.read(_LONGEST).decode("utf-8"))
        return Ledger()

    def _look(self) -> tuple[int, int, int] | None:
        with suppress(OSError):
            found = self._path.stat()
            return found.st_ino, found.st_mtime_ns, found.st_size
        return None

    @contextmanager
    def _lock(self) -> Iterator[None]:
        self._path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        lock = os.open(self._path.with_suffix(".lock"), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, PRIVATE)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield
        finally:
            os.close(lock)
