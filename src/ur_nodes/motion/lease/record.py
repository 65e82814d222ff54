"""Lease of the robot: which client drives, as a step function without clock or topics.

A *client* is a run of a program, with an id of its own; all nodes of a run are one client. At most one client holds the
lease. It keeps it by renewing it or by driving; a holder whose messages have been missing for `timeout` is *lost*,
stays named, and holds the lease again with its next message, unless another client has acquired it meanwhile.

- `acquire` succeeds when the lease is free, or is the client's own, or was lost by a client of the same user and
  computer. A lease that another computer has lost is left to it: its run still exists.
- `take` always succeeds.
- `ask` puts the client on the list of those who ask; where `acquire` would succeed it does that. Who asks has to renew
  that too.
- `grant` by the holder gives the lease to the first who asks.
- `release` by the client that has the lease gives it to the first who asks, or frees it. By one who asks it withdraws
  that.
- A command for motion from a client acquires a free lease.
- A client that gets the lease of another without a grant or a release has taken it from that client (`taken_from`).

A request counts only with a challenge that is not too old: a late `take` takes nothing. A client without an id takes no
part: it is a node on the robot that follows the lease by itself, as move_base
does, and sends to a source for such nodes.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from ur_nodes.motion.lease.text import FREE, MOST_ASKING, Lease, LeaseRequest, Viewer

_NO_REQUESTS: dict[str, LeaseRequest] = {}
_MOST_KNOWN = 64  # clients whose names are remembered


class ClientCommand(NamedTuple):
    """A fresh velocity command of a client has arrived; `motion` is whether it asks for any."""

    client: str
    motion: bool


class LeaseRecord(NamedTuple):
    """The state of the lease, and when clients last sent something.

    `received_at`: the earliest time at which the last message of the holder was sent; `asked`: those of the clients
    that ask; `forget_at`: when a holder that has been lost since the record began is forgotten.
    """

    lease: Lease = FREE
    timeout: float = 3.0
    received_at: float = -math.inf
    asked: tuple[float, ...] = ()  # as lease.asking
    known: dict[str, LeaseRequest] = _NO_REQUESTS  # the last request of each client, newest last
    forget_at: float = math.inf


LeaseEvent = LeaseRequest | ClientCommand


def start_lease(
    before: Lease | None = None, timeout: float = 3.0, *, unix: float | None = None, forget_at: float = math.inf
) -> LeaseRecord:
    """A record in which no client drives; or, after a mux that died, one whose holder is lost until its next message.

    `unix` is the present time, for display; a holder without a message until `forget_at` is forgotten.
    """
    if before is None or before.state == "free":
        return LeaseRecord(timeout=timeout)
    until = before.until if before.state == "lost" else unix
    return LeaseRecord(replace(before, state="lost", asking=(), until=until), timeout, forget_at=forget_at)


def step_lease(record: LeaseRecord, event: LeaseEvent | None, now: float, unix: float, age: float = 0.0) -> LeaseRecord:
    """The record after an event (None: time has passed).

    `now` is in seconds of a steady clock, `unix` in seconds since 1970. Requests must have been checked for freshness;
    no event is older than its `age` (s). Of that, at most half of the timeout counts until its client is lost.
    """
    record, sent = _expire(record, now, unix), now - min(age, record.timeout / 2)
    if isinstance(event, ClientCommand):
        return _drive(record, event, sent, unix)
    return record if event is None else _request(_remember(record, event), event, sent, unix)


def may_drive(record: LeaseRecord, client: str, *, follows: bool = False) -> bool:
    """Return whether commands of this client are accepted; of one without an id, if its source `follows` the lease."""
    return (follows and not client) or record.lease.client in ("", client)


def _request(record: LeaseRecord, request: LeaseRequest, now: float, unix: float) -> LeaseRecord:
    lease, own = record.lease, record.lease.client == request.client
    if own and request.action in ("renew", "acquire", "ask", "take"):
        return _renew(record, request, now)
    if request.action == "take" or (request.action in ("acquire", "ask") and _is_available(lease, request)):
        return _grant(record, request, now, unix, taken=True)
    if request.action == "release":
        withdrawn = _keep_asking(record, lambda person, _: person.client != request.client)
        return _release(record, now, unix, request.note) if own else withdrawn
    if request.action == "grant" and own and lease.asking:
        return _grant_to_first(record, now, unix)
    if request.action in ("ask", "renew"):
        return _ask(record, request, now)
    return record


def _drive(record: LeaseRecord, event: ClientCommand, now: float, unix: float) -> LeaseRecord:
    if not event.client:
        return record
    if record.lease.client == event.client:
        held = record.lease.state == "held" and record.lease.until is None
        lease = record.lease if held else replace(record.lease, state="held", until=None)
        return record._replace(lease=lease, received_at=max(record.received_at, now), forget_at=math.inf)
    if record.lease.state == "free" and event.motion:
        known = record.known.get(event.client) or LeaseRequest(event.client, event.client[:8], "", "acquire")
        return _grant(record, known, now, unix, taken=False)
    return record


def _renew(record: LeaseRecord, request: LeaseRequest, now: float) -> LeaseRecord:
    lease = replace(
        record.lease,
        state="held",
        attended=request.attended,
        name=request.name,
        program=request.program,
        computer=request.computer,
        until=None,
        terms=request.terms,
    )
    return record._replace(lease=lease, received_at=max(record.received_at, now), forget_at=math.inf)


def _grant(record: LeaseRecord, request: LeaseRequest, now: float, unix: float, *, taken: bool) -> LeaseRecord:
    before = record.lease
    record = _keep_asking(record, lambda person, _: person.client != request.client)
    lease = Lease(
        "held",
        request.client,
        request.name,
        request.program,
        unix,
        request.attended,
        record.lease.asking,
        Viewer(before.client, before.name) if taken and before.client else None,
        unix if taken and before.client else None,
        request.computer,
        terms=request.terms,
    )
    return record._replace(lease=lease, received_at=now, forget_at=math.inf)


def _is_available(lease: Lease, request: LeaseRequest) -> bool:
    """Return whether a client may acquire the lease without taking it from a client that may return."""
    if lease.state != "lost":
        return lease.state == "free"
    if lease.computer and request.computer:
        return lease.computer == request.computer
    return lease.name == request.name


def _grant_to_first(record: LeaseRecord, now: float, unix: float) -> LeaseRecord:
    """Give the lease to the first client that asks for it."""
    first = record.lease.asking[0]
    heir = record.known.get(first.client) or LeaseRequest(first.client, first.name, "", "ask")
    return _grant(record, heir, now, unix, taken=False)


def _release(record: LeaseRecord, now: float, unix: float, note: str = "") -> LeaseRecord:
    if record.lease.asking:
        return _grant_to_first(record, now, unix)
    return record._replace(lease=replace(FREE, note=note), received_at=-math.inf, forget_at=math.inf)


def _ask(record: LeaseRecord, request: LeaseRequest, now: float) -> LeaseRecord:
    """Add a client to those that ask, or note that it still asks."""
    clients = [each.client for each in record.lease.asking]
    if request.client in clients:
        index = clients.index(request.client)
        return record._replace(asked=(*record.asked[:index], now, *record.asked[index + 1 :]))
    if request.action != "ask" or len(clients) >= MOST_ASKING:
        return record
    asking = (*record.lease.asking, Viewer(request.client, request.name))
    return record._replace(lease=replace(record.lease, asking=asking), asked=(*record.asked, now))


def _expire(record: LeaseRecord, now: float, unix: float) -> LeaseRecord:
    if not all(0.0 <= now - at <= record.timeout for at in record.asked):
        record = _keep_asking(record, lambda _, at: 0.0 <= now - at <= record.timeout)
    if record.lease.state == "held" and not 0.0 <= now - record.received_at <= record.timeout:
        until = max(0.0, unix - max(0.0, now - record.received_at))
        return record._replace(lease=replace(record.lease, state="lost", until=until))
    if record.lease.state == "lost" and now >= record.forget_at:
        return _release(record, now, unix)
    return record


def _keep_asking(record: LeaseRecord, keeps: Callable[[Viewer, float], bool]) -> LeaseRecord:
    pairs = [pair for pair in zip(record.lease.asking, record.asked, strict=True) if keeps(*pair)]
    asking, asked = tuple(person for person, _ in pairs), tuple(at for _, at in pairs)
    return record._replace(lease=replace(record.lease, asking=asking), asked=asked)


def _remember(record: LeaseRecord, request: LeaseRequest) -> LeaseRecord:
    known = {client: each for client, each in record.known.items() if client != request.client}
    known[request.client] = request
    while len(known) > _MOST_KNOWN:
        del known[next(iter(known))]
    return record._replace(known=known)
