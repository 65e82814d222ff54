"""Sender and age of a goal without synchronised clocks, from the text that our clients write into goal ids.

A goal for which any heading counts is marked there: upstream's `move_base` ignores ids, and arrives with the heading
of the goal's pose.

The mux publishes a new value (a challenge, in ns of its steady clock) about 30 times a second. A client writes the
newest one that it has received into the id of its goal, with its own id: `<any>@<client>@<secs>.<nsecs>`. The receiver
remembers when each challenge arrived, so the age of the goal is at most the time since then.
"""

import re
from dataclasses import dataclass

REMEMBERED = 2.0
"""Seconds for which a challenge is remembered."""

_SUFFIX = re.compile(r"@([0-9A-Za-z_.:-]{1,64})@(\d{1,10})\.(\d{1,9})\Z", re.ASCII)
_ANY_HEADING = "!any-heading"
_ANY_HEADING_ID = re.compile(rf"{_ANY_HEADING}(@[^@]{{1,64}}@[0-9.]{{1,20}})?\Z")
_NANO = 1_000_000_000
_AHEAD = 1.0  # s that a challenge may reach the client before the receiver
_LONGEST_ID = 1024


@dataclass(frozen=True, slots=True)
class Claim:
    """The client that sent a goal, and the challenge (ns) that it answered."""

    client: str
    answer: int


@dataclass(frozen=True, slots=True)
class ReceivedChallenges:
    """The challenges (ns) of the last `REMEMBERED` seconds, each with the time (s) it arrived; oldest first."""

    received: tuple[tuple[int, float], ...] = ()
    newest_at: float | None = None

    def silence(self, now: float) -> float | None:
        """Seconds since the last challenge; None before the first."""
        return None if self.newest_at is None else now - self.newest_at


def note_challenge(challenges: ReceivedChallenges, value: int, now: float) -> ReceivedChallenges:
    """Return the challenges after one has arrived."""
    old = 0
    while old < len(challenges.received) and now - challenges.received[old][1] > REMEMBERED:
        old += 1
    return ReceivedChallenges((*challenges.received[old:], (value, now)), now)


def age_of_answer(challenges: ReceivedChallenges, answer: int, now: float) -> float | None:
    """Return the greatest possible age (s) of an answer; None if its challenge is not of the last `REMEMBERED` seconds.

    Challenges that were delayed arrive together: what is older than the newest by their own values is that old,
    whenever it arrived. A challenge that the receiver has missed, or not received yet, counts from the arrival of the
    one before it.
    """
    if not challenges.received:
        return None
    newest, newest_at = challenges.received[-1]
    behind = (newest - answer) / _NANO
    for value, at in challenges.received:
        if value == answer and now - at <= REMEMBERED:
            return max(now - at, behind)
    if -behind > now - newest_at + _AHEAD:  # another mux's: the clock of this one has not come that far
        return None
    before = [at for value, at in challenges.received if value < answer and now - at <= REMEMBERED]
    return max(now - before[-1], behind) if before else None


def lag_of_answer(challenges: ReceivedChallenges, answer: int, now: float) -> float | None:
    """Estimate the age (s) of an answer to a challenge that is no longer stored; None without an estimate."""
    if not challenges.received:
        return None
    value, at = challenges.received[-1]
    lag = (value - answer) / _NANO + now - at
    return lag if 0.0 < lag < 86400.0 else None


def write_goal_id(start: str, client: str, answer: int) -> str:
    """Return a goal's id with the client that sends it, and the challenge that it answers (ns)."""
    return f"{start}@{client}@{answer // _NANO}.{answer % _NANO:09d}"


def write_any_heading(start: str) -> str:
    """Return the start of the id of a goal for which any heading counts."""
    return f"{start}{_ANY_HEADING}"


def has_any_heading(goal_id: str) -> bool:
    """Return whether the sender of a goal accepts any heading."""
    return len(goal_id) <= _LONGEST_ID and _ANY_HEADING_ID.search(goal_id) is not None


def read_claim(goal_id: str) -> Claim | None:
    """Return the claim in an id; None if there is none, as in ids of other programs."""
    found = _SUFFIX.search(goal_id) if len(goal_id) <= _LONGEST_ID else None
    if found is None:
        return None
    return Claim(found[1], int(found[2]) * _NANO + int(found[3]))
