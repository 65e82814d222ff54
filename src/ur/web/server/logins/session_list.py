"""The logins of all servers of this user, for a terminal. It imports nothing of the server."""

import re
import time
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

from ur.source.diagnostic import UserError, error
from ur.source.printable import printable
from ur.source.suggest import did_you_mean
from ur.web.access.roles import Grant, list_sessions
from ur.web.server.logins.session_file import SessionFile

ALL = "all"
"""The name that stands for every login."""

_FILE = re.compile(r"sessions-(\d{1,5})\.json", re.ASCII)
_HEAD = ("NAME", "MAY", "FROM", "PORT", "LOGGED IN", "LAST SEEN", "GOOD UNTIL")


@dataclass(frozen=True, slots=True)
class Login:
    """A session: its file, the port of its server, its id, and its rights."""

    path: Path
    port: int
    number: str
    grant: Grant


def find_logins(folder: Path, now: float) -> list[Login]:
    """Return the logins that are valid at a time in seconds since 1970, the last used first."""
    found = [login for path in folder.glob("sessions-*.json") for login in _read(path, now)]
    return sorted(found, key=lambda each: (-each.grant.last, each.grant.name, each.number))


def draw_logins(logins: list[Login]) -> list[str]:
    """Return a table of logins, as lines."""
    if not logins:
        return ["no device is logged in"]
    rows = [_HEAD, *map(_describe, logins)]
    widths = [max(len(row[index]) for row in rows) for index in range(len(_HEAD))]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]


def end_logins(logins: list[Login], name: str) -> int:
    """End the logins with a name, or all; return their number. A running server notices at once.

    Raises UserError if none has this name, or a file cannot be written.
    """
    chosen = [each for each in logins if name == ALL or each.grant.name.casefold() == name.casefold()]
    if not chosen and name != ALL:
        near = did_you_mean(name, [each.grant.name for each in logins])
        help_ = f"did you mean {near!r}?" if near else "'ur web --sessions' lists them"
        raise UserError(error(f"no login is named {name!r}", rule="unknown-login", help=help_, subject=name))
    for path in dict.fromkeys(each.path for each in chosen):
        _end(path, [each.number for each in chosen if each.path == path])
    return len(chosen)


def _end(path: Path, numbers: Collection[str]) -> None:
    try:
        SessionFile(path).end(numbers)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(error(f"{path}: cannot be written: {reason}", rule="not-ended")) from None


def _read(path: Path, now: float) -> Iterator[Login]:
    matched = _FILE.fullmatch(path.name)
    if matched is not None:
        for number, grant in list_sessions(SessionFile(path).read(), now).items():
            yield Login(path, int(matched[1]), number, grant)


def _describe(login: Login) -> tuple[str, ...]:
    grant = login.grant
    times = (_write(each) for each in (grant.first, grant.last, grant.until))
    return printable(grant.name), grant.role.value, printable(grant.address) or "?", str(login.port), *times


def _write(moment: float) -> str:
    try:
        return time.strftime("%Y-%m-%d %H:%M", time.localtime(moment)) if moment else "?"
    except (ValueError, OverflowError):
        return "?"
