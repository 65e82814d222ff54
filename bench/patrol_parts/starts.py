"""Starts of a robot that nobody asked for, from a record of its speed, of the patrol's states, and of requests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ur_nodes.client.patrol_text import ACTIVE

ASKED = 5.0
"""Seconds for which a request counts."""

REST, MOTION = 0.01, 0.05  # m/s and rad/s together
_SKEW = 1.0  # s by which a request may be recorded after what it causes: each topic has a connection of its own
_RESTED = 0.5  # s at rest before a motion is a start
_BRAKING = 0.5  # s: what still moves then has not started


@dataclass(frozen=True, slots=True)
class Record:
    """Times (s of one clock) with what came: `speeds`, `states` of the patrol, and `requests` to start or resume."""

    speeds: Sequence[tuple[float, float]]
    states: Sequence[tuple[float, str]]
    requests: Sequence[float]


def find_starts(speeds: Sequence[tuple[float, float]]) -> list[float]:
    """The moments at which a robot that stood begins to move."""
    starts, rested = [], None
    for at, speed in speeds:
        if speed > MOTION and rested is not None and at - rested >= _RESTED:
            starts.append(at)
        rested = (at if rested is None else rested) if speed < REST else None if speed > MOTION else rested
    return starts


def find_unasked(record: Record) -> list[float]:
    """The moments at which the robot, or the patrol, started though nobody had asked within the last `ASKED` seconds.

    A robot may start while its patrol is active; a patrol may become active after a request.
    """
    unasked, active = [], False
    for at, state in record.states:
        begins = state in ACTIVE and not active
        active = state in ACTIVE
        if begins and not _is_asked(at, record.requests):
            unasked.append(at)
    for at in find_starts(record.speeds):
        states = [(since, state) for since, state in record.states if since <= at]
        going = bool(states) and (states[-1][1] in ACTIVE or at - states[-1][0] < _BRAKING)
        if not going and not _is_asked(at, record.requests):
            unasked.append(at)
    return sorted(unasked)


def _is_asked(at: float, requests: Sequence[float]) -> bool:
    return any(-_SKEW <= at - each <= ASKED for each in requests)
