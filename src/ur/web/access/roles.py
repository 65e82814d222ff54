"""Roles, tokens and sessions: who may look, who may drive.

A *token* is what a link carries: it is good for one login within its lifetime. A login makes a *session*, whose secret
is the page's cookie. Viewers that keep no cookie (Foxglove, Lichtblick) connect again and again with one address: it
carries the secret of a *viewer link*, which ends with the server. Of all three only a hash is kept. All times are
seconds since 1970.
"""

from __future__ import annotations

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
_NOTED_EVERY = 60.0  # s: how exactly the last use is known
_LONGEST_SECRET = 128


class Role(str, Enum):
    """LOOK: see everything, and stop the robot in an emergency. DRIVE: everything."""

    LOOK = "look"
    DRIVE = "drive"


@dataclass(frozen=True, slots=True)
class Grant:
    """A right that a secret gives: its role, when it ends, and the name of a session for people.

    `address` is that of the login, at the time `first`; `last` is the time of the last use; 0 where it is not known.
    """

    role: Role
    until: float
    name: str = ""
    address: str = ""
    first: float = 0.0
    last: float = 0.0


@dataclass(frozen=True, slots=True)
class LoginDevice:
    """A device that logs in: the name of its kind for people, its address, and the `life` of the login in s."""

    name: str
    address: str = ""
    life: float = SESSION_LIFE


@dataclass(frozen=True, slots=True)
class Ledger:
    """The tokens, sessions and viewer links that are valid, by the hash of their secret, oldest first."""

    tokens: dict[str, Grant] = field(default_factory=dict)
    sessions: dict[str, Grant] = field(default_factory=dict)
    viewers: dict[str, Grant] = field(default_factory=dict)


def add_token(ledger: Ledger, role: Role, now: float) -> tuple[Ledger, str]:
    """A ledger with a new token, and the token."""
    secret = secrets.token_urlsafe(18)
    tokens = {**_valid(ledger.tokens, now), hash_secret(secret): Grant(role, now + TOKEN_LIFE)}
    return replace(ledger, tokens=dict(list(tokens.items())[-_MOST_TOKENS:])), secret


def use_token(ledger: Ledger, token: object, device: LoginDevice, now: float) -> tuple[Ledger, str | None]:
    """Use a token up: the ledger with a new session, and the session's secret; None for a token that is not valid."""
    key = _key(token)
    grant = ledger.tokens.get(key) if key else None
    if grant is None or now > grant.until:
        return ledger, None
    tokens = {each: value for each, value in ledger.tokens.items() if each != key}
    return open_session(replace(ledger, tokens=tokens), grant.role, device, now)


def open_session(ledger: Ledger, role: Role, device: LoginDevice, now: float) -> tuple[Ledger, str]:
    """The ledger with a new session, whose name no other one has, and the session's secret."""
    secret = secrets.token_urlsafe(32)
    sessions = _valid(ledger.sessions, now)
    name = choose_name(device.name, (each.name for each in sessions.values()))
    grant = Grant(role, now + device.life, name, clean_name(device.address), now, now)
    sessions = {**sessions, hash_secret(secret): grant}
    return replace(ledger, sessions=dict(list(sessions.items())[-_MOST_SESSIONS:])), secret


def add_viewer(ledger: Ledger, role: Role) -> tuple[Ledger, str]:
    """A ledger with a new viewer link, and its secret. The link does not end by itself."""
    secret = secrets.token_urlsafe(18)
    return replace(ledger, viewers={**ledger.viewers, hash_secret(secret): Grant(role, math.inf, "Foxglove")}), secret


def find_viewer(ledger: Ledger, secret: object) -> tuple[str, Grant] | None:
    """The id of a viewer link, which is no secret, and what it grants; None for a secret that is not valid."""
    key = _key(secret)
    grant = ledger.viewers.get(key) if key else None
    return (session_id(key), grant) if grant is not None else None


def find_session(ledger: Ledger, secret: object, now: float) -> tuple[str, Grant] | None:
    """The id of a session, which is no secret, and what it grants; None for a secret that is not valid."""
    key = _key(secret)
    grant = ledger.sessions.get(key) if key else None
    return (session_id(key), grant) if grant is not None and now <= grant.until else None


def note_use(ledger: Ledger, secret: str, now: float) -> Ledger:
    """A session was used, which does not prolong it. The same ledger if that was noted lately."""
    key = _key(secret)
    grant = ledger.sessions.get(key)
    if grant is None or abs(now - grant.last) < _NOTED_EVERY:
        return ledger
    return replace(ledger, sessions={**ledger.sessions, key: replace(grant, last=now)})


def list_sessions(ledger: Ledger, now: float) -> dict[str, Grant]:
    """The sessions that are valid, by their ids, oldest first."""
    return {session_id(key): grant for key, grant in _valid(ledger.sessions, now).items()}


def end_sessions(ledger: Ledger, ids: Collection[str]) -> Ledger:
    """Log out the sessions with these ids."""
    sessions = {key: grant for key, grant in ledger.sessions.items() if session_id(key) not in ids}
    return replace(ledger, sessions=sessions)


def name_session(ledger: Ledger, number: str, name: str) -> Ledger:
    """Give the session with an id another name, to which a number is added where another session has it."""
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
    """A name as it may be shown that is none of `others`: `Linux`, `Linux 2`, `Linux 3`."""
    taken = {each.casefold() for each in others}
    plain = clean_name(name) or "a browser"
    names = itertools.chain([plain], (f"{plain[:35]} {number}" for number in itertools.count(2)))
    return next(each for each in names if each.casefold() not in taken)


def session_id(key: str) -> str:
    """The id of a session from the hash of its secret."""
    return hashlib.sha256(b"id " + key.encode()).hexdigest()[:16]


def hash_secret(secret: str) -> str:
    """The hash that is kept of a secret. Secrets are random, so that the hash needs no salt."""
    return hashlib.sha256(secret.encode()).hexdigest()


def clean_name(text: object) -> str:
    """A name as it may be shown: printable, on one line, at most 40 characters."""
    if not isinstance(text, str):
        return ""
    return "".join(each for each in text[:200] if each.isprintable()).strip()[:40]


def write_sessions(ledger: Ledger) -> str:
    """The sessions as JSON; tokens end with the server."""
    return json.dumps({key: asdict(grant) for key, grant in ledger.sessions.items()}, indent=1) + "\n"


def read_sessions(text: str) -> Ledger:
    """The ledger of such a text; without what is malformed."""
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
