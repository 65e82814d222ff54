"""The lease of a robot: its driver, start time and program; stored on its master's parameter server."""

import os
import time
from collections.abc import Iterable
from typing import Literal

from ur.run.master.client import Master, parse_master_uri
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.middleware.facts import read_facts
from ur.run.remote.protocol import check_printable
from ur.source.data_classes import dataclass
from ur.source.diagnostic import UserError
from ur.source.foreign.json_values import Timestamp, convert_json, read_json
from ur.system.ros import find_facts, read_domain

PARAMETER = "/ur/lease"
LeaseState = Literal["free", "held", "lost"]
Mode = Literal["drive", "take", "ask", "watch"]
_PATIENCE = 1.0  # s
_MAX_LENGTH = 1 << 16
_DAY = 86400.0


@dataclass(frozen=True, slots=True)
class RobotLease:
    """The client that drives a robot: its id, its computer's name, its program, and its start (s since the epoch).

    "lost": nothing was received from the client for a while; `until`: time of the last message, 0 if unknown. It still
    has the lease until another client takes it. `computer` identifies its computer and user, empty if the client does
    not send it.
    """

    state: LeaseState = "free"
    client: str = ""
    name: str = ""
    program: str = ""
    since: Timestamp = 0.0
    computer: str = ""
    until: Timestamp = 0.0


def read_lease(master_uri: str) -> RobotLease:
    """Read the lease from a master. It is free without an answer, or if no robot of this project runs."""
    try:
        if (domain := read_domain(master_uri)) is not None:
            path = find_facts(os.environ, domain)
            return parse_lease(read_facts(path).get("lease"))
        asked = parse_master_uri(master_uri)
        text = Master(asked.uri, asked.host, asked.port, _PATIENCE).call("getParam", PARAMETER)
        return parse_lease(text)
    except (Unanswered, CallRefused, UserError, ValueError, TypeError):
        return RobotLease()


def parse_lease(text: object) -> RobotLease:
    """Parse a lease from another computer. Raises ValueError if it is invalid."""
    fields = read_json(text, dict[str, object], _MAX_LENGTH)
    if "state" not in fields:
        raise ValueError("state: expected one of free, held, lost")
    found = convert_json({name: value for name, value in fields.items() if value is not None}, RobotLease)
    for each in (found.client, found.name, found.program, found.computer):
        check_printable(each)
    return found


def describe_lease(lease: RobotLease, robot: str, now: float) -> str:
    """Format a lease for display: 'laptop drives bob since 14:02 (keyboard_drive)'. `now` is in s since the epoch."""
    program = f" ({lease.program})" if lease.program else ""
    name = lease.name or "another computer"
    if lease.state == "lost":
        until = f" until {_format_time(lease.until, now)}" if lease.until else ""
        return f"{name} drove {robot}{until}{program} and is out of reach"
    since = f" since {_format_time(lease.since, now)}" if lease.since else ""
    return f"{name} drives {robot}{since}{program}"


def belongs_to_other(lease: RobotLease, name: str, computer: str, own: Iterable[str]) -> bool:
    """Return whether another client has the lease, also one that is lost.

    `name` and `computer` are this computer's; `own` are the ids of the clients that run on it. A client of this
    computer that was killed is not among them, though its lease lasts longer.
    """
    if lease.state == "free":
        return False
    here = lease.computer == computer if lease.computer and computer else lease.name == name
    return not here or lease.client in set(own)


def _format_time(at: float, now: float) -> str:
    return time.strftime("%H:%M" if abs(now - at) < _DAY / 2 else "%d %b %H:%M", time.localtime(at))
