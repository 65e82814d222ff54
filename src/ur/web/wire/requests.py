"""Requests of pages, as JSON: what comes from a browser is hostile until it is read here.

A request that sets something in motion carries `n`, the newest challenge of the mux that the page has received.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, cast

from ur.web.wire.map_requests import MAP_READERS, MapRequest
from ur.web.wire.reading import (
    FARTHEST,
    BadRequestError,
    choose_reader,
    is_count,
    read_name,
    read_number,
    read_object,
    read_pose,
)

Stamp = tuple[int, int]
"""Seconds and nanoseconds of a challenge of the mux."""

PatrolAction = Literal["start", "pause", "resume", "end"]
LeaseAction = Literal["acquire", "take", "ask", "grant", "release"]

LONGEST = 4096
"""Characters of the longest request."""

MOST_STOPS = 50
"""Places of a patrol."""

LEAST_LIMIT = 10
"""Percent: the lowest speed limit of a page."""


@dataclass(frozen=True, slots=True)
class Alive:
    """The page is there, and has received the challenge `answers`."""

    answers: Stamp


@dataclass(frozen=True, slots=True)
class Stick:
    """A velocity (m/s, rad/s) while the user holds the stick; each press begins a `hold` with a higher number."""

    answers: Stamp
    hold: int
    forward: float
    turn: float


@dataclass(frozen=True, slots=True)
class LetGo:
    """The user has let go of the stick, or the page takes it so."""

    hold: int


@dataclass(frozen=True, slots=True)
class GoalRequest:
    """Drive to a place in the map frame; any heading counts there where `yaw` is None."""

    answers: Stamp
    x: float
    y: float
    yaw: float | None


@dataclass(frozen=True, slots=True)
class GoTo:
    """Drive to a place by its name."""

    answers: Stamp
    place: str


@dataclass(frozen=True, slots=True)
class InitialPose:
    """The robot is here, in the map frame."""

    answers: Stamp
    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True)
class Cancel:
    """Cancel the goal, whoever sent it."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Continue the goal that is held."""

    answers: Stamp


@dataclass(frozen=True, slots=True)
class AskForLease:
    """A request about the lease."""

    answers: Stamp
    action: LeaseAction


@dataclass(frozen=True, slots=True)
class Emergency:
    """Stop everything that drives, or release that."""

    stop: bool


@dataclass(frozen=True, slots=True)
class AskPatrol:
    """Have the robot start a patrol, or pause, resume or end the one that it drives.

    `stops` are names of places, or x, y in m in the map frame, where any heading counts. `wait` s at each.
    """

    answers: Stamp
    action: PatrolAction
    stops: tuple[str | tuple[float, float], ...] = ()
    loop: bool = False
    wait: float = 1.0


@dataclass(frozen=True, slots=True)
class LimitSpeed:
    """Let nothing drive faster than this percentage of the base's highest speeds."""

    percent: int


@dataclass(frozen=True, slots=True)
class SwitchObstacleStop:
    """Let the mux stop commands of people before obstacles, or follow them."""

    on: bool


Request = (
    Alive
    | Stick
    | LetGo
    | GoalRequest
    | GoTo
    | InitialPose
    | Cancel
    | Resume
    | AskForLease
    | Emergency
    | AskPatrol
    | LimitSpeed
    | SwitchObstacleStop
    | MapRequest
)


def read_request(text: object) -> Request:
    """The request that a text is. Raises BadRequestError."""
    value = read_object(text, LONGEST)
    return choose_reader(value, _READERS)(value)


def _stamp(value: Mapping[str, Any]) -> Stamp:
    found = value.get("n")
    if not isinstance(found, list) or len(found) != 2 or not all(is_count(each) for each in found):
        raise BadRequestError("n: expected a challenge, two whole numbers below 2^32")
    return found[0], found[1]


def _hold(value: Mapping[str, Any]) -> int:
    hold = value.get("hold")
    if not is_count(hold) or hold == 0:
        raise BadRequestError("hold: expected a whole number from 1 to 2^32 - 1")
    return int(cast("int", hold))


def _goal(value: Mapping[str, Any]) -> tuple[float, float, float | None]:
    return read_pose(value) if value.get("yaw") is not None else (*read_pose({**value, "yaw": 0.0})[:2], None)


def _patrol(value: Mapping[str, Any]) -> AskPatrol:
    action, found, loop = value.get("do"), value.get("places", []), value.get("loop", False)
    if not isinstance(action, str) or action not in ("start", "pause", "resume", "end"):
        raise BadRequestError("do: expected one of start, pause, resume, end")
    least = 1 if action == "start" else 0
    if not isinstance(found, list) or not least <= len(found) <= MOST_STOPS or not isinstance(loop, bool):
        raise BadRequestError(f"places: expected 1 to {MOST_STOPS} names or [x, y]; loop: true or false")
    stops = tuple(_stop(each) for each in found)
    wait = read_number(value, "wait", 3600.0) if "wait" in value else 1.0
    if wait < 0.0:
        raise BadRequestError("wait: expected seconds from 0 to 3600")
    return AskPatrol(_stamp(value), cast("PatrolAction", action), stops, loop, wait)


def _stop(value: object) -> str | tuple[float, float]:
    if isinstance(value, list) and len(value) == 2:
        x, y = (read_number({"places": each}, "places", FARTHEST) for each in value)
        return x, y
    return read_name({"places": value}, "places")


def _limit(value: Mapping[str, Any]) -> LimitSpeed:
    percent = value.get("percent")
    if type(percent) is not int or not LEAST_LIMIT <= percent <= 100:
        raise BadRequestError(f"percent: expected a whole number from {LEAST_LIMIT} to 100")
    return LimitSpeed(percent)


def _obstacles(value: Mapping[str, Any]) -> SwitchObstacleStop:
    on = value.get("on")
    if not isinstance(on, bool):
        raise BadRequestError("on: expected true or false")
    return SwitchObstacleStop(on)


def _lease(value: Mapping[str, Any]) -> AskForLease:
    action = value.get("do")
    if not isinstance(action, str) or action not in ("acquire", "take", "ask", "grant", "release"):
        raise BadRequestError("do: expected one of acquire, take, ask, grant, release")
    return AskForLease(_stamp(value), cast("LeaseAction", action))


_READERS: Mapping[str, Callable[[Mapping[str, Any]], Request]] = {
    "alive": lambda value: Alive(_stamp(value)),
    "stick": lambda value: Stick(
        _stamp(value), _hold(value), read_number(value, "forward", 100.0), read_number(value, "turn", 100.0)
    ),
    "let_go": lambda value: LetGo(_hold(value)),
    "goal": lambda value: GoalRequest(_stamp(value), *_goal(value)),
    "go_to": lambda value: GoTo(_stamp(value), read_name(value)),
    "pose": lambda value: InitialPose(_stamp(value), *read_pose(value)),
    "cancel": lambda _: Cancel(),
    "resume": lambda value: Resume(_stamp(value)),
    "lease": _lease,
    "limit": _limit,
    "obstacles": _obstacles,
    "patrol": _patrol,
    "stop": lambda _: Emergency(stop=True),
    "release": lambda _: Emergency(stop=False),
    **MAP_READERS,
}
