"""Lease and requests as JSON, which is how they travel. Everything from outside is hostile until it is checked here."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, cast, get_args

from ur_nodes.motion.challenge.freshness import NO_STAMP, Stamp

Action = Literal["acquire", "renew", "ask", "take", "release", "grant"]
LeaseState = Literal["free", "held", "lost"]

MOST_ASKING = 16
LONGEST_NAME = 64
_LONGEST_REQUEST = 1024  # characters
_LONGEST_LEASE = 8192
_CLIENT = re.compile(r"[0-9A-Za-z_.:-]{1,64}", re.ASCII)


@dataclass(frozen=True, slots=True)
class Viewer:
    """A client, and the name of the computer that it runs on."""

    client: str
    name: str


@dataclass(frozen=True, slots=True)
class Lease:
    """The lease: nobody drives (`free`), a client (`held`), or one whose renewals have stopped arriving (`lost`).

    `since`, `taken_at` and `until` are seconds since 1970 by the robot's clock, for people to read; `until` is the time
    of the last message of a client that is lost, if known. `attended` says that a person watches; `asking` who would
    like to drive; `taken_from` who drove before the client took over. `computer` identifies a user of a computer, where
    names may be alike; it is empty for a client that sends none.
    """

    state: LeaseState = "free"
    client: str = ""
    name: str = ""
    program: str = ""
    since: float = 0.0
    attended: bool = True
    asking: tuple[Viewer, ...] = ()
    taken_from: Viewer | None = None
    taken_at: float | None = None
    computer: str = ""
    until: float | None = None


@dataclass(frozen=True, slots=True)
class LeaseRequest:
    """A client's request about the lease, and the newest challenge that the client had received."""

    client: str
    name: str
    program: str
    action: Action
    attended: bool = True
    answers: Stamp = NO_STAMP
    computer: str = ""


FREE = Lease()


def is_client(text: object) -> bool:
    """Return whether this can be the id of a client."""
    return isinstance(text, str) and _CLIENT.fullmatch(text) is not None


def write_request(request: LeaseRequest) -> str:
    """The request as JSON."""
    return json.dumps(
        {
            "client": request.client,
            "name": request.name,
            "program": request.program,
            "action": request.action,
            "attended": request.attended,
            "answers": list(request.answers),
            "computer": request.computer,
        }
    )


def read_request(text: str) -> LeaseRequest | str:
    """The request that the text is, or why it is none, to be continued after "a request"."""
    value = _read_object(text, _LONGEST_REQUEST)
    if isinstance(value, str):
        return value
    client, action, attended = value.get("client"), value.get("action"), value.get("attended", True)
    answers = value.get("answers")
    if not is_client(client):
        return "whose client is not an id of at most 64 letters, digits, '_', '.', ':' and '-'"
    if action not in get_args(Action):
        return f"whose action is not one of {', '.join(get_args(Action))}"
    if not isinstance(attended, bool):
        return "whose 'attended' is neither true nor false"
    if not (isinstance(answers, list) and len(answers) == 2 and all(_is_count(each) for each in answers)):
        return "that answers no challenge"
    name, program = clean_name(value.get("name")), clean_name(value.get("program"))
    return LeaseRequest(
        str(client),
        name or str(client)[:8],
        program,
        cast("Action", action),
        attended,
        (answers[0], answers[1]),
        clean_computer(value.get("computer")),
    )


def write_lease(lease: Lease) -> str:
    """The lease as JSON."""
    return json.dumps(
        {
            "state": lease.state,
            "client": lease.client,
            "name": lease.name,
            "program": lease.program,
            "since": lease.since,
            "attended": lease.attended,
            "asking": [_write_person(each) for each in lease.asking],
            "taken_from": _write_person(lease.taken_from) if lease.taken_from else None,
            "taken_at": lease.taken_at,
            "computer": lease.computer,
            "until": lease.until,
        }
    )


def read_lease(text: object) -> Lease | None:
    """The lease that the text is; None if it is none."""
    value = _read_object(text, _LONGEST_LEASE)
    if isinstance(value, str):
        return None
    state, client, attended, asking = (value.get(key) for key in ("state", "client", "attended", "asking"))
    if state not in get_args(LeaseState) or not (client == "" or is_client(client)) or not isinstance(attended, bool):
        return None
    if (state == "free") is not (client == "") or not isinstance(asking, list) or len(asking) > MOST_ASKING:
        return None
    people = tuple(_read_person(each) for each in asking)
    taken_from = value.get("taken_from")
    before = None if taken_from is None else _read_person(taken_from)
    if None in people or (before is None and taken_from is not None):
        return None
    return Lease(
        cast("LeaseState", state),
        str(client),
        clean_name(value.get("name")),
        clean_name(value.get("program")),
        _read_time(value.get("since")) or 0.0,
        attended,
        tuple(each for each in people if each is not None),
        before,
        _read_time(value.get("taken_at")),
        clean_computer(value.get("computer")),
        _read_time(value.get("until")),
    )


def clean_computer(value: object) -> str:
    """The identity of a user of a computer, which has the form of a client's id; empty for what is none."""
    return str(value) if is_client(value) else ""


def clean_name(value: object) -> str:
    """A name as it may be shown: printable, on one line, at most 64 characters; empty for what is no text."""
    if not isinstance(value, str):
        return ""
    return "".join(each for each in value[: 4 * LONGEST_NAME] if each.isprintable()).strip()[:LONGEST_NAME]


def _write_person(person: Viewer) -> dict[str, str]:
    return {"client": person.client, "name": person.name}


def _read_person(value: object) -> Viewer | None:
    if not isinstance(value, Mapping) or not is_client(value.get("client")):
        return None
    return Viewer(str(value["client"]), clean_name(value.get("name")))


def _read_time(value: object) -> float | None:
    """Seconds since 1970; None for what is no time of this millennium's first century."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 <= value < 4.2e9:
        return None
    return float(value)


def _is_count(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**32


def _read_object(text: object, longest: int) -> dict[str, Any] | str:
    if not isinstance(text, str) or len(text) > longest:
        return f"of more than {longest} characters"
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        return "that is not JSON"
    return value if isinstance(value, dict) else "that is not a JSON object"
