"""Admission of velocity commands to the mux: the accepted commands, and their ages.

A *stamped* command answers a challenge and names its client: it is admitted when the answer is fresh and the client may
drive, and its age counts from the issue of the challenge. A *plain* command has no proof of its age: it is admitted by
its publisher's rhythm, counts from its arrival, and is ignored while stamped commands come from the same source. Where
the middleware stamps messages, it is as old as its stamp shows beside the fastest one of its publisher (`stamps`).

All functions are pure; `now` is in seconds of a steady clock, `unix` in seconds since 1970.
"""

import math
from typing import Literal, NamedTuple, TypeVar

from ur_nodes.motion.admission.probation import Probation, restart_proof, step_probation, too_slow
from ur_nodes.motion.challenge.freshness import (
    FRESHNESS,
    NO_STAMP,
    REQUEST_FRESHNESS,
    IssuedChallenges,
    Stamp,
    age_of,
    issue,
)
from ur_nodes.motion.lease.record import ClientCommand, LeaseRecord, may_drive, step_lease
from ur_nodes.motion.lease.text import LeaseRequest, is_client

# The age of velocity commands that carry no answer to a challenge, from the stamps that their middleware puts on them.
# ROS 2 stamps each message by the clock of the computer that sends it. Clocks of two computers agree on nothing, but
# the difference between a message's arrival and its stamp is its delay and a constant. So the fastest message of a
# publisher shows the constant, and a message is older than the fastest one was by what its own difference exceeds the
# least.
# - *Drift*: the least difference seen may grow by `DRIFT`, by which clocks run apart while neither is set. - A clock
# that is set ahead, or a first message that was slow, shows as a difference that falls. So does a queue that a network
# empties: its messages are old, each less so than the one before. Where the least falls by more than `FALL`, the
# publisher has to prove its rhythm again (`admission.probation`), until its differences no longer fall. - A clock that
# is set back shows as commands that are late from then on, and look like those of a network that holds each command
# back. They stay late: the program has to be started again, which makes it another publisher.
# So the age is a lower bound: a network that delays every message of a publisher since its first one evenly is not
# seen. All functions are pure; stamps are in ns of the sender's clock, arrivals in s of a steady clock.


DRIFT = 500e-6  # s in each s: the rate at which NTP corrects a clock; quartz differs by a fifth of it
FALL = 0.02  # s
_NANO = 1_000_000_000


class Stamps(NamedTuple):
    """The stamps of a publisher: the `least` difference (s) that was seen, `at` which arrival, since `origin` (ns).

    `proven` is the least difference when the publisher began to prove its rhythm.
    """

    origin: int = 0
    least: float = math.inf
    at: float = -math.inf
    proven: float = math.inf


def step_stamps(state: Stamps, sent: int, arrived: float) -> tuple[Stamps, float, bool]:
    """Return the state after a message, its age (s) against the fastest one, and whether the differences fell."""
    if math.isinf(state.least):
        return Stamps(sent, arrived, arrived, arrived), 0.0, False
    difference = arrived - (sent - state.origin) / _NANO
    expected = state.least + DRIFT * max(0.0, arrived - state.at)
    if difference > expected:
        return state, difference - expected, False
    fell = difference < state.proven - FALL
    proven = difference if fell else max(state.proven, difference)
    return Stamps(state.origin, difference, arrived, proven), 0.0, fell


_MOST_PUBLISHERS = 32
_MOST_STAMPS = 512  # of publishers: one that is forgotten could pass old commands off as new

Refusal = Literal["late", "held back", "not the driver", "no client", "on probation", "displaced", "driver silent"]
Publisher = tuple[int, str]  # of plain commands: index of the source, id of the publisher
Kept = TypeVar("Kept", Probation, Stamps)
Sent = tuple[int, float]  # when a command was sent (ns of the sender's clock), and when it arrived (s)


_NO_PROBATIONS: dict[Publisher, Probation] = {}
_NO_TIMES: dict[int, float] = {}
_NO_STAMPS: dict[Publisher, Stamps] = {}


class Admission(NamedTuple):
    """The challenges, the lease, the publishers of plain commands, and the last stamped command of each source."""

    challenges: IssuedChallenges
    lease: LeaseRecord
    timeouts: tuple[float, ...]  # s, of the sources
    freshness: float = FRESHNESS
    plain: dict[Publisher, Probation] = _NO_PROBATIONS
    stamped_at: dict[int, float] = _NO_TIMES
    stamps: dict[Publisher, Stamps] = _NO_STAMPS


def admit_stamped(
    admission: Admission,
    source: int,
    answer: Stamp,
    client: str,
    now: float,
    unix: float,
    *,
    motion: bool,
    follows: bool = False,
    waited: float = 0.0,
) -> tuple[Admission, float | Refusal]:
    """Return the age (s) of a stamped command, or why it is refused; it arrived fresh if it then `waited` (s) here.

    A source that `follows` the lease may send without an id of a client, also while a client has it.
    """
    if client and client != admission.lease.lease.client and not is_client(client):
        return admission, "no client"
    age = age_of(admission.challenges, answer, now, admission.freshness + waited)
    if age is None:
        return admission, "late"
    lease = step_lease(admission.lease, ClientCommand(client, motion), now, unix, age)
    if not may_drive(lease, client, follows=follows):
        return admission._replace(lease=lease), "not the driver"
    admission = admission._replace(lease=lease, stamped_at={**admission.stamped_at, source: now})
    return admission, age if client and client == lease.lease.client else hold_to_terms(admission, age, now)


def admit_plain(
    admission: Admission,
    source: int,
    publisher: str,
    now: float,
    *,
    motion: bool,
    sent: Sent | None = None,
    stream: str = "",
) -> tuple[Admission, float | Refusal]:
    """Return the age (s) of a plain command, or why it is refused. Without a known time `sent`, the age is 0.

    `stream` is that of a `Sender`: each proves its own rhythm; all of a publisher have one least difference.
    """
    key = (source, publisher)
    rhythm = (source, f"{publisher} {stream}" if stream else publisher)
    probation = admission.plain.get(rhythm, Probation(admission.timeouts[source]))
    age = 0.0
    if sent is not None:
        stamps, delay, fell = step_stamps(admission.stamps.get(key, Stamps()), *sent)
        age = delay + max(0.0, now - sent[1])
        admission = admission._replace(stamps=_with(admission.stamps, key, stamps, _MOST_STAMPS))
        if age > admission.freshness:
            return admission, "held back"
        if fell:
            probation = restart_proof(probation)
    state = step_probation(probation, now if sent is None else sent[1], motion=motion, aged=sent is not None)
    admission = admission._replace(plain=_with(admission.plain, rhythm, state, _MOST_PUBLISHERS))
    if not state.accepted:
        return admission, "on probation"
    if now - admission.stamped_at.get(source, -math.inf) <= admission.timeouts[source]:
        return admission, "displaced"
    return admission, hold_to_terms(admission, age, now)


def hold_to_terms(admission: Admission, age: float, now: float) -> float | Refusal:
    """Return the age (s) of a command from another sender than the driver, under the terms of the driver.

    The command is then no younger than the driver's last sign of life, so the robot is at rest as soon after that as
    after the last command.
    """
    record = admission.lease
    if record.lease.terms is None:
        return age
    request = record.known.get(record.lease.client)
    answer = NO_STAMP if request is None else request.answers
    silence = age_of(admission.challenges, answer, now, record.lease.terms.keep)
    return "driver silent" if silence is None else max(age, silence)


def _with(known: dict[Publisher, Kept], key: Publisher, value: Kept, most: int) -> dict[Publisher, Kept]:
    """Return the dict with a value as its newest; beyond `most` values, the oldest are dropped."""
    kept = {each: before for each, before in known.items() if each != key}
    kept[key] = value
    while len(kept) > most:
        del kept[next(iter(kept))]
    return kept


def admit_request(admission: Admission, request: LeaseRequest, now: float, unix: float) -> tuple[Admission, bool]:
    """Return the admission after a request about the lease, and whether the request was fresh and so accepted."""
    age = age_of(admission.challenges, request.answers, now, REQUEST_FRESHNESS)
    if age is None:
        return admission, False
    return admission._replace(lease=step_lease(admission.lease, request, now, unix, age)), True


def challenge(admission: Admission, now: float, unix: float) -> tuple[Admission, Stamp, tuple[Publisher, ...]]:
    """Issue a challenge, let time pass for the lease, and name the publishers that turn out to be too slow to drive."""
    challenges, stamp = issue(admission.challenges, now)
    checked = {key: too_slow(state, now) for key, state in admission.plain.items()}
    slow = tuple(key for key, (_, is_slow) in checked.items() if is_slow)
    if slow:
        admission = admission._replace(plain={key: state for key, (state, _) in checked.items()})
    lease = step_lease(admission.lease, None, now, unix)
    return admission._replace(challenges=challenges, lease=lease), stamp, slow
