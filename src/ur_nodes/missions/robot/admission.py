"""Admission of requests for a patrol: those that start motion must be fresh, and of a client that may drive."""

from __future__ import annotations

from ur_nodes.client.patrol_text import PatrolRequest
from ur_nodes.motion.lease.text import Lease
from ur_nodes.navigation.goals.attendance import LATEST, clock_time, name_of_driver
from ur_nodes.navigation.goals.goal_claim import ReceivedChallenges, age_of_answer, lag_of_answer

_NANO = 1_000_000_000


def refuse_request(
    request: PatrolRequest, lease: Lease | None, own: str, challenges: ReceivedChallenges, now: float, *, latched: bool
) -> str:
    """Return the reason why a request is refused; '' when it is accepted.

    `own` is the patrol's client of the lease, which is None where the mux has none. `latched`: the publisher keeps the
    message for subscribers that come later, so nothing shows its age. To pause and to end is never refused.
    """
    if request.action in ("pause", "end"):
        return ""
    if lease is not None and lease.client not in ("", own) and lease.client != (request.client or None):
        if lease.state == "held":
            return f"{name_of_driver(lease)} drives since {clock_time(lease.since)}"
        return f"{name_of_driver(lease)} drove and is out of reach, take over first"
    if request.answers is None:
        return "a latched request may be old; publish it without latching, or with a challenge" if latched else ""
    answer = request.answers[0] * _NANO + request.answers[1]
    age = age_of_answer(challenges, answer, now)
    if age is not None and age <= LATEST:
        return ""
    lag = age if age is not None else lag_of_answer(challenges, answer, now)
    return f"the request arrived late{'' if lag is None else f' ({lag:.1f} s)'}, send it again"
