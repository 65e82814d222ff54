"""Admission of a page's stick: a command counts while its press lasts, and only if it is young.

A press (`hold`) whose commands stay away, or arrive late, is over: the user has to let go and press again. So nothing
that was held back by a network, and no stick that was forgotten in a hidden page, moves the robot after a gap.

Pure functions; `now` and ages are in seconds of a steady clock.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal

from ur_nodes.motion.challenge.freshness import FRESHNESS

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
