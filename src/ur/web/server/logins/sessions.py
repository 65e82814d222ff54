"""The sessions of a running server: their private file, their open connections, and reports of logins."""

import asyncio
import time
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ur.source.replace import PRIVATE, replace_file
from ur.web.access.roles import (
    SESSION_LIFE,
    Grant,
    Ledger,
    LoginDevice,
    Role,
    add_token,
    add_viewer,
    end_sessions,
    find_session,
    find_viewer,
    list_sessions,
    name_session,
    note_use,
    open_session,
    read_sessions,
    use_token,
    write_sessions,
)
from ur.web.server.links import LinkFiles

_LONGEST = 1 << 20  # bytes of the file
_SAVED_EVERY = 3600.0  # s: the precision of the last use after the server was killed


def discard_line(_line: str) -> None:
    """Discard a line, for servers that report logins only to the log."""


class Sessions:
    """Tokens, sessions and viewer links of a server. When a session ends, its open connections are closed."""

    def __init__(
        self,
        path: Path,
        log: Callable[[str], None],
        links: LinkFiles | None = None,
        report: Callable[[str], None] = discard_line,
        life: float = SESSION_LIFE,
        clock: Callable[[], float] = time.time,
    ) -> None:
        """Load the sessions. `links` were made by other commands; `report` is called with a line about each login.

        `life` is the validity of a login in s.
        """
        self._path, self._log, self._links = path, log, links
        self._report, self.life = report, life
        self._ledger = Ledger()
        with suppress(OSError, UnicodeDecodeError), path.open("rb") as file:
            self._ledger = read_sessions(file.read(_LONGEST).decode("utf-8"))
        self._open: dict[str, set[asyncio.Transport]] = {}
        self._saved_at = time.monotonic()
        self._clock = clock

    def invite(self, role: Role) -> str:
        """Create a token for one login."""
        self._ledger, token = add_token(self._ledger, role, self._clock())
        return token

    def invite_viewer(self, role: Role) -> str:
        """Create the secret of a viewer link."""
        self._ledger, secret = add_viewer(self._ledger, role)
        return secret

    def log_in(self, token: object, name: str, address: str, before: str = "") -> str | None:
        """Consume a token: return the secret of a new session; None for an invalid token.

        `before` is the id of the browser's previous session, which the new one replaces under the same name.
        """
        now, former = self._clock(), self.list().get(before)
        device = LoginDevice(former.name if former else name, address, self.life)
        kept = end_sessions(self._ledger, [before])
        ledger, secret = use_token(kept, token, device, now)
        role = self._links.use(token) if secret is None and self._links is not None else None
        if role is not None:
            ledger, secret = open_session(kept, role, device, now)
        if secret is None:
            return None
        self._ledger = ledger
        self.save()
        for transport in list(self._open.get(before, ())):
            transport.close()
        found = find_session(self._ledger, secret, now)
        assert found is not None, "just opened"
        line = f"{found[1].name} logged in from {address} and may {found[1].role.value}"
        self._log(line)
        self._report(f"{time.strftime('%H:%M:%S')} {line}")
        return secret

    def find(self, secret: object) -> tuple[str, Grant] | None:
        """Return the id of a session, which is not secret, and its rights; None for an invalid secret."""
        return find_session(self._ledger, secret, self._clock())

    def find_viewer(self, secret: object) -> tuple[str, Grant] | None:
        """Return the same for a viewer link."""
        return find_viewer(self._ledger, secret)

    def note_use(self, secret: str) -> None:
        """Record the use of a session. The file is updated with the next change, or within an hour."""
        self._ledger = note_use(self._ledger, secret, self._clock())

    def list(self) -> dict[str, Grant]:
        """Return the valid sessions by their ids, oldest first."""
        return list_sessions(self._ledger, self._clock())

    def count_open(self, number: str) -> int:
        """Count the open web sockets of a session."""
        return len(self._open.get(number, ()))

    def rename(self, number: str, name: str) -> str:
        """Rename a session, and return its new name, which may have a number."""
        self._ledger = name_session(self._ledger, number, name)
        self.save()
        grant = self.list().get(number)
        return grant.name if grant else ""

    def end(self, ids: Collection[str]) -> None:
        """End sessions, and close their connections."""
        before = self.list()
        self._ledger = end_sessions(self._ledger, ids)
        self.save()
        for number in ids:
            if number in before:
                self._log(f"{before[number].name}: the session has ended")
            for transport in list(self._open.get(number, ())):
                transport.close()

    def poll(self) -> None:
        """End expired sessions, and save the last uses now and then."""
        expired = self._open.keys() - self.list().keys()
        if expired:
            self.end(expired)
        elif time.monotonic() - self._saved_at > _SAVED_EVERY:
            self.save(lasting=False)  # a slow disk would delay every request

    @contextmanager
    def hold(self, number: str, transport: asyncio.Transport | None) -> Iterator[None]:
        """Close a connection if its session ends while the context lasts."""
        if transport is None:
            yield
            return
        self._open.setdefault(number, set()).add(transport)
        try:
            yield
        finally:
            self._open[number].discard(transport)
            if not self._open[number]:
                del self._open[number]

    def save(self, *, lasting: bool = True) -> None:
        """Write the file; with `lasting`, it is on the disk when this returns."""
        self._saved_at = time.monotonic()
        try:
            replace_file(self._path, write_sessions(self._ledger), mode=PRIVATE, parents=True, lasting=lasting)
        except OSError as problem:
            self._log(f"{self._path}: sessions are not saved: {problem.strerror}")
