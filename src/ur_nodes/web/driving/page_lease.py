"""Lease requests on behalf of a page, sent when the page proves that it is connected.

Each page is a client of its own. Its requests carry the challenge that the page itself has answered, so the lease is
lost when the page, and not only this program, is out of reach.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal

from ur_nodes.motion.challenge.freshness import FRESHNESS
from ur_nodes.motion.lease.requests import PATIENCE, LeaseRequests, step_requests
from ur_nodes.motion.lease.text import Action, Lease

GAP = 0.3
"""Seconds without a young command after which a press is over."""

Verdict = Literal["drive", "over", "ignore"]


@dataclass(frozen=True, slots=True)
class StickState:
    """The newest press of a page: whether it lasts, and when its last fresh command arrived."""

    hold: int = 0
    live: bool = False
    at: float = -math.inf


def step_stick(state: StickState, hold: int, age: float | None, now: float) -> tuple[StickState, Verdict]:
    """Take a command of the press `hold`, whose challenge is `age` old (None: not known).

    `drive`: pass it on. `over`: this press is over just now, stop. `ignore`: nothing follows from it.
    """
    if hold < state.hold:
        return state, "ignore"
    began = hold > state.hold
    if began:
        state = StickState(hold, live=True, at=now)
    if not state.live:
        return state, "ignore"
    if age is None or age > FRESHNESS or now - state.at > GAP:
        return replace(state, live=False), "over"
    return replace(state, at=now), "drive"


def let_go(state: StickState, hold: int) -> tuple[StickState, Verdict]:
    """End press `hold`, which the user has released."""
    if hold < state.hold:
        return state, "ignore"
    return StickState(hold, live=False, at=state.at), "over"


def end_stick(state: StickState) -> tuple[StickState, Verdict]:
    """End the press of a page that has disconnected."""
    return replace(state, live=False), "over" if state.live else "ignore"


def expire_stick(state: StickState, now: float) -> tuple[StickState, Verdict]:
    """End a press whose commands have stopped arriving."""
    if state.live and now - state.at > GAP:
        return replace(state, live=False), "over"
    return state, "ignore"


HAND_BACK = 3.0
"""Seconds after the end of a page's goal after which its lease is released."""


@dataclass(frozen=True, slots=True)
class PageLease:
    """A page's client id and its browser (`computer`).

    `wanted` is the action that has not taken effect yet; it is given up after the time `until` (s). `ended_at` is when
    the page's goal ended or was refused; None: it drives to one, or its user has driven by hand or asked since.
    """

    client: str
    computer: str = ""
    wanted: Action | None = None
    until: float = 0.0
    ended_at: float | None = None


def request_action(page: PageLease, action: Action, now: float) -> PageLease:
    """Note the lease action that the user of the page requests at `now` (s)."""
    return replace(page, wanted=action, until=now + PATIENCE, ended_at=None)


def note_end(page: PageLease, now: float) -> PageLease:
    """Note that the page's goal has ended, or was refused: the lease goes back soon."""
    return page if page.ended_at is not None else replace(page, ended_at=now)


def step_page(page: PageLease, lease: Lease | None, now: float) -> tuple[PageLease, Action | None]:
    """Return the lease request to send after a proof of the page; None while it only watches."""
    if lease is None:
        return page, None
    state = LeaseRequests(page.client, "watch", lease, intent=page.wanted, give_up_at=page.until, begun=True)
    state, action = step_requests(state, now, linked=True)
    page = replace(page, wanted=state.intent)
    over = page.wanted is None and page.ended_at is not None and now - page.ended_at >= HAND_BACK
    if over and lease.client == page.client:
        return request_action(page, "release", now), "release"
    return page, action


def participates(page: PageLease, lease: Lease) -> bool:
    """Return whether the page has the lease, or asks for it."""
    return lease.client == page.client or any(each.client == page.client for each in lease.asking)


def may_drive(page: PageLease, lease: Lease | None) -> bool:
    """Return whether commands of the page are to be sent: it drives, it may acquire that, or there is no lease."""
    return lease is None or lease.client == page.client or may_acquire(page, lease)


def may_acquire(page: PageLease, lease: Lease) -> bool:
    """Return whether no client drives, or only a page of the same browser that has disconnected."""
    return lease.state == "free" or (lease.state == "lost" and bool(page.computer) and lease.computer == page.computer)
