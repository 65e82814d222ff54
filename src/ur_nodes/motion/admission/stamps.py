"""The age of velocity commands that carry no answer to a challenge, from the stamps that their middleware puts on them.

ROS 2 stamps each message by the clock of the computer that sends it. Clocks of two computers agree on nothing, but the
difference between a message's arrival and its stamp is its delay and a constant. So the fastest message of a publisher
shows the constant, and a message is older than the fastest one was by what its own difference exceeds the least.

- *Drift*: the least difference seen may grow by `DRIFT`, by which clocks run apart while neither is set.
- A clock that is set ahead, or a first message that was slow, shows as a difference that falls. So does a queue that a
  network empties: its messages are old, each less so than the one before. Where the least falls by more than `FALL`,
  the publisher has to prove its rhythm again (`admission.probation`), until its differences no longer fall.
- A clock that is set back shows as commands that are late from then on, and look like those of a network that holds
  each command back. They stay late: the program has to be started again, which makes it another publisher.

So the age is a lower bound: a network that delays every message of a publisher since its first one evenly is not seen.
All functions are pure; stamps are in ns of the sender's clock, arrivals in s of a steady clock.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

DRIFT = 500e-6  # s in each s: the rate at which NTP corrects a clock; quartz differs by a fifth of it
FALL = 0.02  # s
_NANO = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Stamps:
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
