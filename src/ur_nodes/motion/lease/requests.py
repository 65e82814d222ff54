"""Requests of a client about the lease: what to send next, as a step function without clock or topics."""

from dataclasses import dataclass, replace

from ur_nodes.motion.lease.text import Action, Lease
from ur_nodes.motion.lease.view import Conduct, LeaseView, first_action, is_settled, view_lease

PATIENCE = 2.0
"""Seconds after which a request that has not taken effect is given up."""

_START_PATIENCE = 4.5  # s: likewise at the start; by then a holder that was killed just before is lost


@dataclass(frozen=True, slots=True)
class LeaseRequests:
    """A client's state: the lease as last received, and the requested action (`intent`).

    `taken_over` is the lease when another client took it over from this one. `begun`: the first request of the conduct
    was made; `silent`: nothing is sent any more.
    """

    client: str
    conduct: Conduct
    lease: Lease | None = None
    taken_over: Lease | None = None
    intent: Action | None = None
    give_up_at: float = 0.0
    begun: bool = False
    silent: bool = False

    @property
    def settled(self) -> bool:
        """Return whether the first request has taken effect or was given up."""
        return self.begun and self.intent is None

    def view(self, link_age: float) -> LeaseView:
        """Return the lease as the client sees it; `link_age` (s) is that of the newest challenge."""
        pending = not self.silent and not self.settled
        return view_lease(self.lease, self.client, self.taken_over, link_age, pending=pending)


def want(state: LeaseRequests, action: Action, now: float) -> LeaseRequests:
    """Return the state in which an action is requested from now (s) on, until it has taken effect."""
    return replace(state, begun=True, silent=False, intent=action, give_up_at=now + PATIENCE)


def let_go(state: LeaseRequests, *, silent: bool) -> LeaseRequests:
    """Return the state after a release: for what is wanted next the lease is free, until the mux publishes it."""
    lease = state.lease
    if lease is not None and lease.client == state.client:
        lease = Lease(asking=lease.asking)
    return replace(state, lease=lease, intent=None, silent=silent)


def apply_lease(state: LeaseRequests, lease: Lease) -> LeaseRequests:
    """The state after a lease was received."""
    taken = state.taken_over
    if lease.client == state.client:
        taken = None
    elif lease.taken_from is not None and lease.taken_from.client == state.client:
        taken = lease
    settled = state.intent is not None and is_settled(state.intent, lease, state.client)
    return replace(state, lease=lease, taken_over=taken, intent=None if settled else state.intent)


def step_requests(state: LeaseRequests, now: float, *, linked: bool) -> tuple[LeaseRequests, Action | None]:
    """Return the state now (s), and the message to send; `linked`: the mux is connected and its challenges arrive."""
    lease = state.lease
    if lease is None or state.silent:
        return state, None
    if not state.begun and linked:
        first = first_action(state.conduct, lease)
        state = replace(state, begun=True, intent=first, give_up_at=now + _START_PATIENCE)
    if state.intent and (is_settled(state.intent, lease, state.client) or now > state.give_up_at):
        state = replace(state, intent=None)
    participates = state.intent or state.client in (lease.client, *(each.client for each in lease.asking))
    if not state.begun or (state.conduct == "watch" and not participates):
        return state, None
    return state, state.intent or "renew"
