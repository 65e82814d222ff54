"""The state of an exploration as a value, as JSON for the topic, and as sentences for people."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from ur.source.foreign.json_values import BadJsonError, convert_json, read_json, write_json

State = Literal["starting", "exploring", "paused", "complete", "incomplete", "stopped"]

ENDED: tuple[State, ...] = ("complete", "incomplete", "stopped")
_LONGEST = 65536  # characters of a status; what comes from a network is checked
_SHOWN = 4  # unreachable frontiers, and corners, in a line


@dataclass(frozen=True, slots=True)
class ExploreStatus:
    """The state of an exploration. Areas in m2, `way` in m, `seconds` since the begin.

    `reachable` frontiers are left, and about `unknown` of floor; each of `unreachable` is a clause with the reason.
    `corners` are places that hide so little that no client drives there.
    `reason` is why it is paused or has ended; `saved` is the name of the map once it is stored.
    `left` is a rough estimate of the time until the end, s; None while there is none.
    """

    state: State = "starting"
    reachable: int = 0
    unknown: float = 0.0
    known: float = 0.0
    way: float = 0.0
    seconds: float = 0.0
    unreachable: tuple[str, ...] = ()
    corners: tuple[str, ...] = ()
    reason: str = ""
    saved: str = ""
    left: float | None = None

    @property
    def ended(self) -> bool:
        """Return whether the exploration is over."""
        return self.state in ENDED

    def with_map(self, name: str) -> ExploreStatus:
        """The same with the name of the stored map; '' where it is not stored."""
        return replace(self, saved=name)


def write_status(status: ExploreStatus) -> str:
    """The status as JSON, one object."""
    return write_json(status)


def read_status(text: str) -> ExploreStatus | None:
    """The status in a message; None when it is not one."""
    try:
        fields = read_json(text, dict[str, object], _LONGEST)
        known = "unreachable" in fields and set(fields).issubset(ExploreStatus.__slots__)
        return convert_json(fields, ExploreStatus) if known else None
    except BadJsonError:
        return None


def describe_status(status: ExploreStatus) -> str:
    """One line about a status."""
    if status.state == "starting":
        return f"waiting: {status.reason}" if status.reason else "waiting for the map"
    done = describe_done(status)
    if status.state == "paused":
        return f"paused: {status.reason}; {done}"
    if status.state == "exploring":
        return f"{done}; {describe_left(status)}{_blocked(status)}"
    return f"{describe_end(status)}; {done}"


def describe_end(status: ExploreStatus) -> str:
    """The clause about why an exploration has ended."""
    if status.state == "complete":
        return f"the map is complete: 0 frontiers reachable{_left_out(status)}{_blocked(status)}"
    head = "stopped" if status.state == "stopped" else "the map is not complete"
    return f"{head}: {status.reason}; {describe_left(status)}{_blocked(status)}"


def describe_done(status: ExploreStatus) -> str:
    """The clause about the known floor and the way driven."""
    return f"{status.known:.0f} m² known, {status.way:.0f} m driven in {_clock(status.seconds)}"


def describe_left(status: ExploreStatus) -> str:
    """The clause about the frontiers that are left, and how long they will take where that can be estimated."""
    time = "" if status.left is None else f", about {max(1, round(status.left / 60.0))} min left"
    return f"{_count(status.reachable, 'frontier')} left, about {status.unknown:.0f} m² unknown{time}"


def describe_blocked(status: ExploreStatus) -> str:
    """The clause about frontiers that cannot be reached; empty for none."""
    return f"{len(status.unreachable)} unreachable: {_some(status.unreachable)}" if status.unreachable else ""


def _left_out(status: ExploreStatus) -> str:
    if not status.corners:
        return ""
    return f"; {_count(len(status.corners), 'corner')} left out: {_some(status.corners)}"


def _blocked(status: ExploreStatus) -> str:
    text = describe_blocked(status)
    return f"; {text}" if text else ""


def _some(texts: tuple[str, ...]) -> str:
    more = len(texts) - _SHOWN
    return ", ".join(texts[:_SHOWN]) + (f", and {more} more" if more > 0 else "")


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02} min"
