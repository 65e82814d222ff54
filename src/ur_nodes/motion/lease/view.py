"""A client's view of the lease, and how a client behaves: what to request next, as pure functions."""

import os
import re
import socket
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, cast, get_args

from ur_nodes.motion.lease.text import Action, Lease, clean_computer, clean_name, is_client

Conduct = Literal["drive", "take", "ask", "watch"]
_LOST_LINK = 1.0  # s: after that silence the robot is out of reach


@dataclass(frozen=True, slots=True)
class Identity:
    """The identity of a client, and its conduct at its start: `drive` acquires the lease if it is free.

    `computer` identifies the user of the computer; empty if unknown.
    """

    client: str
    name: str
    program: str
    conduct: Conduct = "drive"
    attended: bool = True
    computer: str = ""


@dataclass(frozen=True, slots=True)
class LeaseView:
    """The lease as a client sees it now.

    `state` is `unknown` until a mux publishes it. `holder` names the computer that drives, `program` its program,
    `since` is in seconds since 1970, as is `until`, when a holder that is `lost` was received last. `mine`: this client
    drives, even while it is `lost`. `asking` names who would like to drive, `asks`: this client does. After a take-over
    `taken_by` and `taken_at` are the client that took over and the time, until this client drives again. `link_age` is
    the time since the last challenge (s), infinite before the first. `pending`: a request of this client has not taken
    effect yet and is not given up. `note`: why the last client has let go, where it has named a reason.
    """

    state: Literal["unknown", "free", "held", "lost"] = "unknown"
    holder: str = ""
    program: str = ""
    since: float = 0.0
    mine: bool = False
    attended: bool = True
    asking: tuple[str, ...] = ()
    asks: bool = False
    taken_by: str = ""
    taken_at: float | None = None
    link_age: float = float("inf")
    until: float | None = None
    pending: bool = False
    note: str = ""

    @property
    def other(self) -> bool:
        """Return whether another client holds the lease."""
        return self.state == "held" and not self.mine

    @property
    def lost_by_other(self) -> bool:
        """Return whether another client has the lease and the robot gets no messages of it."""
        return self.state == "lost" and not self.mine

    @property
    def out_of_reach(self) -> bool:
        """Return whether the lease is known but challenges do not arrive."""
        return self.state != "unknown" and self.link_age > _LOST_LINK


def identify(environment: Mapping[str, str], program: str) -> Identity:
    """Return the identity that the environment gives, or a new one.

    Variables: UR_CLIENT, UR_CLIENT_NAME, UR_COMPUTER, UR_LEASE, UR_ATTENDED, and UR_PROGRAM, else `program`.
    """
    client, conduct = environment.get("UR_CLIENT", ""), environment.get("UR_LEASE", "drive")
    return Identity(
        client if is_client(client) else os.urandom(8).hex(),
        clean_name(environment.get("UR_CLIENT_NAME"))
        or re.sub(r"[.].*", "", clean_name(socket.gethostname()))
        or "a computer",
        clean_name(environment.get("UR_PROGRAM")) or program,
        cast("Conduct", conduct) if conduct in get_args(Conduct) else "drive",
        environment.get("UR_ATTENDED", "1") != "0",
        clean_computer(environment.get("UR_COMPUTER")),
    )


def first_action(conduct: Conduct, lease: Lease) -> Action | None:
    """Return the first request of a client with this conduct.

    A free lease is acquired with the first command; a lease that a program of the same user on this computer has lost
    is acquired at once, so that a program drives again after a crash and restart.
    """
    if conduct == "drive":
        return "acquire" if lease.state == "lost" else None
    return conduct if conduct in ("take", "ask") else None


def is_settled(action: Action, lease: Lease, client: str) -> bool:
    """Return whether an action has taken effect and needs no more requests."""
    own, asks = lease.client == client, any(each.client == client for each in lease.asking)
    if action in ("acquire", "take"):
        return own and lease.state == "held"
    if action == "ask":
        return (own and lease.state == "held") or asks
    return not own and (action == "grant" or not asks)


def view_lease(
    lease: Lease | None, client: str, taken_over: Lease | None, link_age: float, *, pending: bool = False
) -> LeaseView:
    """Return the view of `client`; `taken_over` is the lease when another client took it over from this one."""
    if lease is None:
        return LeaseView(link_age=link_age, pending=pending)
    if taken_over is not None and taken_over.client != lease.client:
        taken_over = None  # another client drives by now
    return LeaseView(
        lease.state,
        lease.name,
        lease.program,
        lease.since,
        lease.client == client,
        lease.attended,
        tuple(each.name or each.client[:8] for each in lease.asking if each.client != client),
        any(each.client == client for each in lease.asking),
        taken_over.name if taken_over else "",
        taken_over.taken_at if taken_over else None,
        link_age,
        lease.until,
        pending,
        lease.note,
    )
