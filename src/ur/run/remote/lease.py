"""The lease of a robot: its driver, since when, with which program; stored on its master's parameter server."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from ur.run.master.client import Master, parse_master_uri
from ur.run.master.xml_rpc import Refused, Unanswered
from ur.run.remote.protocol import check_printable
from ur.source.diagnostic import UserError

PARAMETER = "/ur/lease"
LeaseState = Literal["free", "held", "lost"]
Mode = Literal["drive", "take", "ask", "watch"]
_PATIENCE = 1.0  # s
_MAX_LENGTH = 1 << 16
_DAY = 86400.0


@dataclass(frozen=True, slots=True)
class Lease:
    """The client that drives a robot: its id, its computer's name, its program, and since when (s since the epoch).

    "lost": nothing was heard of the client for a while; anybody may drive.
    """

    state: LeaseState = "free"
    client: str = ""
    name: str = ""
    program: str = ""
    since: float = 0.0


def read_lease(master_uri: str) -> Lease:
    """Read the lease from a master. Free where nobody answers, or where no robot of ours runs."""
    try:
        asked = parse_master_uri(master_uri)
        text = Master(asked.uri, asked.host, asked.port, _PATIENCE).call("getParam", PARAMETER)
        return parse_lease(text)
    except (Unanswered, Refused, UserError, ValueError, TypeError):
        return Lease()


def parse_lease(text: object) -> Lease:
    """Read a lease that another computer has sent. Raises ValueError or TypeError for anything else."""
    if not isinstance(text, str) or len(text) > _MAX_LENGTH:
        raise TypeError("expected a short text")
    try:
        fields = json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None
    if not isinstance(fields, dict):
        raise TypeError("expected an object")
    state = fields.get("state")
    if state not in ("free", "held", "lost"):
        raise ValueError("state")
    since = fields.get("since") or 0.0
    if isinstance(since, bool) or not isinstance(since, (int, float)) or not 0.0 <= since < 1e11:
        raise ValueError("since")
    client, name, program = (check_printable(fields.get(key) or "") for key in ("client", "name", "program"))
    return Lease(state, client, name, program, float(since))


def describe_lease(lease: Lease, robot: str, now: float) -> str:
    """Format a lease for people: 'laptop drives bob since 14:02 (keyboard_drive)'. `now` is in s since the epoch."""
    when = time.strftime("%H:%M" if abs(now - lease.since) < _DAY / 2 else "%d %b %H:%M", time.localtime(lease.since))
    since = f" since {when}" if lease.since else ""
    program = f" ({lease.program})" if lease.program else ""
    return f"{lease.name or 'another computer'} drives {robot}{since}{program}"


def is_held_by_other(lease: Lease, name: str, own: Iterable[str]) -> bool:
    """Return whether another client drives. `name` is this computer's; `own` are the ids of the clients that run on it.

    An own client that was killed is no longer there, though its lease lasts a little longer.
    """
    return lease.state == "held" and (lease.name != name or lease.client in set(own))
