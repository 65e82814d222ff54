"""The challenges that the robot's end has received lately, and so the age of a page's answer to one of them.

The mux checks the age of each command itself, by its own clock. This check comes before it, so that a page learns at
once that its press is over.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field

from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS, Stamp


@dataclass(frozen=True, slots=True)
class Heard:
    """Challenges with the time of their arrival, oldest first; `newest` is None before the first."""

    at: OrderedDict[Stamp, float] = field(default_factory=OrderedDict)
    newest: Stamp | None = None


def hear(heard: Heard, challenge: Stamp, now: float) -> Heard:
    """A challenge has arrived."""
    kept = OrderedDict((each, at) for each, at in heard.at.items() if now - at <= REQUEST_FRESHNESS)
    kept[challenge] = now
    return Heard(kept, challenge)


def age_of_answer(heard: Heard, answer: Stamp, now: float) -> float | None:
    """Seconds since the challenge arrived here; None for one that did not arrive within the last second."""
    at = heard.at.get(answer)
    return max(0.0, now - at) if at is not None and now - at <= REQUEST_FRESHNESS else None
