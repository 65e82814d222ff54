"""Age of messages from commanders, measured by one clock: that of the computer that executes them.

The mux issues *challenges*, one every 20 ms, or 50 ms while commanders are silent, each a number that is never issued
again. A commander puts the newest challenge that it has received into its message. So the message was written after
that challenge was issued, and its age is at most the time since then, for any delay of the message and any time of the
commander's clock. An answer that the mux did not issue within the horizon has no age.

All functions are pure; `now` is in seconds of a steady clock that also runs while the computer sleeps.
"""

from dataclasses import dataclass, field

FRESHNESS = 0.15  # s: how old the challenge may be that a velocity command answers
REQUEST_FRESHNESS = 1.0  # s: likewise for a request about the lease, which sets nothing in motion by itself
_NANO = 1_000_000_000
_MOST_SECONDS = 2**32  # a ROS time has 32 bits for the seconds

Stamp = tuple[int, int]  # seconds and nanoseconds, as in a ROS time
NO_STAMP: Stamp = (0, 0)  # what a message has whose sender sets no stamp: never issued


@dataclass(frozen=True, slots=True)
class IssuedChallenges:
    """The challenges of the last `horizon` seconds, each with the time of its issue, oldest first."""

    offset: int  # ns: where the count begins; random, so that a mux that is started again repeats none
    horizon: float = REQUEST_FRESHNESS
    issued: dict[Stamp, float] = field(default_factory=dict)
    last: int = 0  # ns: the newest

    def __post_init__(self) -> None:
        """Raise ValueError for an offset that does not fit into the stamps."""
        if not 0 < self.offset < _MOST_SECONDS * _NANO // 2:
            raise ValueError(f"offset: {self.offset}, expected a positive number of nanoseconds within 68 years")


def issue(challenges: IssuedChallenges, now: float) -> tuple[IssuedChallenges, Stamp]:
    """Issue a challenge at `now`, greater than all before it and never issued by the same mux before."""
    number = max(challenges.offset + max(0, round(now * _NANO)), challenges.last + 1) % (_MOST_SECONDS * _NANO)
    stamp = divmod(number, _NANO)
    kept = dict(challenges.issued)
    while kept and kept[newest := next(reversed(kept))] > now + _ROUNDING:  # time was set back
        del kept[newest]
    while kept and now - kept[oldest := next(iter(kept))] > challenges.horizon:
        del kept[oldest]
    kept[stamp] = now
    return IssuedChallenges(challenges.offset, challenges.horizon, kept, number), stamp


_ROUNDING = 1e-6


def age_of(challenges: IssuedChallenges, answer: Stamp, now: float, limit: float = FRESHNESS) -> float | None:
    """Seconds since the challenge `answer` was issued; None if it was not, or longer ago than `limit`."""
    at = challenges.issued.get(answer)
    if at is None:
        return None
    age = now - at
    return max(0.0, age) if age <= limit and age >= -_ROUNDING else None
