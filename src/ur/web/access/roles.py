"""Roles, tokens and sessions: the right to view, and the right to drive.

A *token* is part of a link and valid for one login within its lifetime. A login creates a *session*, whose secret is
the page's cookie. Viewers without cookies (Foxglove, Lichtblick) connect repeatedly with one address, which contains
the secret of a *viewer link*; the link ends with the server. Only hashes of all three are stored. All times are seconds
since 1970.
"""

import hashlib
import itertools
import json
import math
import secrets
from collections.abc import Collection, Iterable
from dataclasses import asdict, dataclass, field, replace
from enum import Enum

from ur.source.foreign.json_values import BadJsonError, convert_json, read_json

TOKEN_LIFE = 3600.0
"""Seconds for which a link may be used."""

DAY = 86400.0
"""Seconds of a day."""

SESSION_LIFE = 30 * DAY
"""Seconds for which a session lasts from its login on, unless the server is started with another."""

_MOST_SESSIONS = 100
_MOST_TOKENS = 100
_NOTED_EVERY = 60.0  # s: the precision of the last use
_LONGEST_SECRET = 128


class Role(str, Enum):
    """LOOK: view everything, and trigger the emergency stop. DRIVE: all rights."""

    LOOK = "look"
    DRIVE = "drive"


@dataclass(frozen=True, slots=True)
class Grant:
    """The rights of a secret: its role, its end, and the display name of a session.

    `address` is that of the login, at the time `first`; `last` is the time of the last use; 0 if unknown.
    """

    role: Role
    until: float
    name: str = ""
    address: str = ""
    first: float = 0.0
    last: float = 0.0


@dataclass(frozen=True, slots=True)
class LoginDevice:
    """A device that logs in: the display name of its kind, its address, and the `life` of the login in s."""

    name: str
    address: str = ""
    life: float = SESSION_LIFE


@dataclass(frozen=True, slots=True)
class Ledger:
    """The valid tokens, sessions and viewer links, by the hash of their secret, oldest first."""

    tokens: dict[str, Grant] = field(default_factory=dict)
    sessions: dict[str, Grant] = field(default_factory=dict)
    viewers: dict[str, Grant] = field(default_factory=dict)


def add_token(ledger: Ledger, role: Role, now: float) -> tuple[Ledger, str]:
    """Return a ledger with a new token, and the token."""
    secret = secrets.token_urlsafe(18)
    tokens = {**_valid(ledger.tokens, now), hash_secret(secret): Grant(role, now + TOKEN_LIFE)}
    return replace(ledger, tokens=dict(list(tokens.items())[-_MOST_TOKENS:])), secret


def use_token(ledger: Ledger, token: object, device: LoginDevice, now: float) -> tuple[Ledger, str | None]:
    """Consume a token: return the ledger with a new session, and the session's secret; None for an invalid token."""
    key = _key(token)
    grant = ledger.tokens.get(key) if key else None
    if grant is None or now > grant.until:
        return ledger, None
    tokens = {each: value for each, value in ledger.tokens.items() if each != key}
    return open_session(replace(ledger, tokens=tokens), grant.role, device, now)


def open_session(ledger: Ledger, role: Role, device: LoginDevice, now: float) -> tuple[Ledger, str]:
    """Return the ledger with a new session under a unique name, and the session's secret."""
    secret = secrets.token_urlsafe(32)
    sessions = _valid(ledger.sessions, now)
    name = choose_name(device.name, (each.name for each in sessions.values()))
    grant = Grant(role, now + device.life, name, clean_name(device.address), now, now)
    sessions = {**sessions, hash_secret(secret): grant}
    return replace(ledger, sessions=dict(list(sessions.items())[-_MOST_SESSIONS:])), secret


def add_viewer(ledger: Ledger, role: Role) -> tuple[Ledger, str]:
    """Return a ledger with a new viewer link, which has no expiry, and its secret."""
    secret = secrets.token_urlsafe(18)
    return replace(ledger, viewers={**ledger.viewers, hash_secret(secret): Grant(role, math.inf, "Foxglove")}), secret


def find_viewer(ledger: Ledger, secret: object) -> tuple[str, Grant] | None:
    """Return the id of a viewer link, which is not secret, and its rights; None for an invalid secret."""
    key = _key(secret)
    grant = ledger.viewers.get(key) if key else None
    return (session_id(key), grant) if grant is not None else None


def find_session(ledger: Ledger, secret: object, now: float) -> tuple[str, Grant] | None:
    """Return the id of a session, which is not secret, and its rights; None for an invalid secret."""
    key = _key(secret)
    grant = ledger.sessions.get(key) if key else None
    return (session_id(key), grant) if grant is not None and now <= grant.until else None


def note_use(ledger: Ledger, secret: str, now: float) -> Ledger:
    """Record the use of a session, which does not prolong it; return the same ledger if a use was recorded recently."""
    key = _key(secret)
    grant = ledger.sessions.get(key)
    if grant is None or abs(now - grant.last) < _NOTED_EVERY:
        return ledger
    return replace(ledger, sessions={**ledger.sessions, key: replace(grant, last=now)})


def list_sessions(ledger: Ledger, now: float) -> dict[str, Grant]:
    """Return the valid sessions by their ids, oldest first."""
    return {session_id(key): grant for key, grant in _valid(ledger.sessions, now).items()}


def end_sessions(ledger: Ledger, ids: Collection[str]) -> Ledger:
    """Log out the sessions with these ids."""
    sessions = {key: grant for key, grant in ledger.sessions.items() if session_id(key) not in ids}
    return replace(ledger, sessions=sessions)


def name_session(ledger: Ledger, number: str, name: str) -> Ledger:
    """Rename the session with an id; a number is appended to a name that another session has."""
    others = [grant.name for key, grant in ledger.sessions.items() if session_id(key) != number]
    chosen = choose_name(name, others)
    return replace(
        ledger,
        sessions={
            key: replace(grant, name=chosen) if session_id(key) == number else grant
            for key, grant in ledger.sessions.items()
        },
    )


def choose_name(name: str, others: Iterable[str]) -> str:
    """Return a printable name that is none of `others`: `Linux`, `Linux 2`, `Linux 3`."""
    taken = {each.casefold() for each in others}
    plain = clean_name(name) or "a browser"
    names = itertools.chain([plain], (f"{plain[:35]} {number}" for number in itertools.count(2)))
    return next(each for each in names if each.casefold() not in taken)


def session_id(key: str) -> str:
    """Return the id of a session from the hash of its secret."""
    return hashlib.sha256(b"id " + key.encode()).hexdigest()[:16]


def hash_secret(secret: str) -> str:
    """Return the hash under which a secret is stored. Secrets are random, so the hash needs no salt."""
    return hashlib.sha256(secret.encode()).hexdigest()


def clean_name(text: object) -> str:
    """Return a name in displayable form: printable, on one line, at most 40 characters."""
    if not isinstance(text, str):
        return ""
    return "".join(each for each in text[:200] if each.isprintable()).strip()[:40]


def write_sessions(ledger: Ledger) -> str:
    """Return the sessions as JSON; tokens are not stored."""
    return json.dumps({key: asdict(grant) for key, grant in ledger.sessions.items()}, indent=1) + "\n"


def read_sessions(text: str) -> Ledger:
    """Parse the ledger from such a text, without malformed entries."""
    try:
        found = read_json(text, dict[str, object])
    except BadJsonError:
        return Ledger()
    sessions = {key: grant for key, value in found.items() if (grant := _read_grant(value)) and len(key) == 64}
    return Ledger(sessions=sessions)


def _read_grant(value: object) -> Grant | None:
    try:
        grant = convert_json(value, Grant)
    except BadJsonError:
        return None
    return replace(grant, name=clean_name(grant.name), address=clean_name(grant.address))


def _valid(grants: dict[str, Grant], now: float) -> dict[str, Grant]:
    return {key: grant for key, grant in grants.items() if now <= grant.until}


def _key(secret: object) -> str:
    if not isinstance(secret, str) or not 0 < len(secret) <= _LONGEST_SECRET or not secret.isascii():
        return ""
    return hash_secret(secret)
