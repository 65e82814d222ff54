"""A patrol and requests for one: values, JSON as it travels, sentences. What comes from a network is checked here."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, cast, get_args

PatrolState = Literal["idle", "starting", "driving", "waiting", "paused", "done", "ended"]
PatrolAction = Literal["start", "pause", "resume", "end"]
Stamp = tuple[int, int]

MOST_PLACES = 50
LONGEST_NAME = 64
LONGEST_WAIT = 3600.0
"""Seconds at a place."""

_LONGEST = 16384  # characters
_FARTHEST = 1e5  # m
ACTIVE: tuple[PatrolState, ...] = ("starting", "driving", "waiting")


class BadPatrolError(ValueError):
    """A text that is no request or status; the message continues "expected "."""


@dataclass(frozen=True, slots=True)
class PatrolStop:
    """A place of a patrol in the map: m, m, rad. Without `yaw` any heading counts.

    `x` is None in a request by name: the robot looks the place up among its waypoints.
    """

    name: str = ""
    x: float | None = None
    y: float = 0.0
    yaw: float | None = None


@dataclass(frozen=True, slots=True)
class PatrolRoute:
    """Places in their order; `wait` s at each; `loop`: again from the first after the last."""

    stops: tuple[PatrolStop, ...] = ()
    loop: bool = False
    wait: float = 1.0


@dataclass(frozen=True, slots=True)
class PatrolAnswer:
    """The answer to a request by its id; `problem` is '' when it was accepted."""

    id: str
    problem: str = ""


@dataclass(frozen=True, slots=True)
class PatrolStatus:
    """The state of the patrol. `index` of the stop that is driven to, or waited at; `rounds` that are complete.

    `reason`: why it is paused or has ended. `answer` to the newest request.
    """

    state: PatrolState = "idle"
    route: PatrolRoute = PatrolRoute()
    index: int = 0
    rounds: int = 0
    reason: str = ""
    answer: PatrolAnswer | None = None

    @property
    def active(self) -> bool:
        """Return whether the patrol moves the robot, or will without another request."""
        return self.state in ACTIVE

    @property
    def stop(self) -> PatrolStop:
        """The stop that is driven to, or waited at."""
        stops = self.route.stops
        return stops[self.index] if self.index < len(stops) else PatrolStop()


@dataclass(frozen=True, slots=True)
class PatrolRequest:
    """A request. `answers` the newest challenge of the mux that the client `client` has received; None: no client."""

    action: PatrolAction
    route: PatrolRoute = PatrolRoute()
    id: str = ""
    client: str = ""
    name: str = ""
    answers: Stamp | None = None


def write_request(request: PatrolRequest) -> str:
    """The request as JSON."""
    value: dict[str, Any] = {"do": request.action, "id": request.id}
    if request.action == "start":
        value |= _write_route(request.route)
    if request.answers is not None:
        value |= {"client": request.client, "name": request.name, "answers": list(request.answers)}
    return json.dumps(value)


def read_request(text: object) -> PatrolRequest:
    """The request that a text is. Raises BadPatrolError."""
    value = _read_object(text)
    action = value.get("do")
    if action not in get_args(PatrolAction):
        raise BadPatrolError(f"do: one of {', '.join(get_args(PatrolAction))}")
    route = read_route(value) if action == "start" else PatrolRoute()
    client, answers = value.get("client", ""), value.get("answers")
    if answers is not None:
        good = isinstance(answers, list) and len(answers) == 2 and all(_is_count(each) for each in answers)
        if not good or not _text(value, "client"):
            raise BadPatrolError("client and answers: the id of a client, and a challenge of the mux as [secs, nsecs]")
    return PatrolRequest(
        cast("PatrolAction", action),
        route,
        _text(value, "id"),
        client if answers is not None else "",
        _text(value, "name"),
        (answers[0], answers[1]) if answers is not None else None,
    )


def write_status(status: PatrolStatus) -> str:
    """The status as JSON, one object."""
    answer = status.answer
    return json.dumps(
        {
            "state": status.state,
            **_write_route(status.route),
            "index": status.index,
            "rounds": status.rounds,
            "reason": status.reason,
            "answer": None if answer is None else {"id": answer.id, "problem": answer.problem},
        }
    )


def read_status(text: object) -> PatrolStatus | None:
    """The status in a message; None when it is not one."""
    try:
        value = _read_object(text)
        state, index, rounds, answer = (value.get(key) for key in ("state", "index", "rounds", "answer"))
        if state not in get_args(PatrolState) or not _is_count(index) or not _is_count(rounds):
            return None
        route = PatrolRoute() if not value.get("places") else read_route(value)
        known = PatrolAnswer(_text(answer, "id"), _text(answer, "problem", 500)) if isinstance(answer, dict) else None
        reason = _text(value, "reason", 500)
    except BadPatrolError:
        return None
    return PatrolStatus(cast("PatrolState", state), route, cast("int", index), cast("int", rounds), reason, known)


def read_route(value: Mapping[str, Any]) -> PatrolRoute:
    """The route in the fields `places`, `loop` and `wait`. Raises BadPatrolError."""
    places, loop, wait = value.get("places"), value.get("loop", False), value.get("wait", 1.0)
    if not isinstance(places, list) or not 1 <= len(places) <= MOST_PLACES:
        raise BadPatrolError(f"places: a list of 1 to {MOST_PLACES} names or poses")
    if not isinstance(loop, bool):
        raise BadPatrolError("loop: true or false")
    if not _is_number(wait, LONGEST_WAIT) or wait < 0.0:
        raise BadPatrolError(f"wait: seconds from 0 to {LONGEST_WAIT:g}")
    return PatrolRoute(tuple(_read_stop(each) for each in places), loop, float(wait))


def describe_patrol(status: PatrolStatus) -> str:
    """One line about a patrol; '' while there is none."""
    stops = status.route.stops
    name = name_stop(status.stop)
    where = f" ({status.index + 1} of {len(stops)}{f', round {status.rounds + 1}' if status.route.loop else ''})"
    if status.state in ("starting", "driving"):
        return f"patrol: drives to {name}{where}"
    if status.state == "waiting":
        return f"patrol: waits at {name}{where}"
    if status.state == "paused":
        return f"patrol paused before {name}{where}: {status.reason}"
    if status.state == "done":
        return "patrol: done"
    return f"patrol ended{f': {status.reason}' if status.reason else ''}" if status.state == "ended" else ""


def name_stop(stop: PatrolStop) -> str:
    """A name for people: that of the place, else its coordinates."""
    return stop.name or f"({stop.x or 0.0:.2f}, {stop.y:.2f})"


def _write_route(route: PatrolRoute) -> dict[str, Any]:
    places = [
        {"name": each.name} | ({} if each.x is None else {"x": each.x, "y": each.y, "yaw": each.yaw})
        for each in route.stops
    ]
    return {"places": places, "loop": route.loop, "wait": route.wait}


def _read_stop(value: object) -> PatrolStop:
    if isinstance(value, str):
        value = {"name": value}
    if not isinstance(value, dict):
        raise BadPatrolError('each place: a name, or {"x": m, "y": m, "yaw": rad}')
    name, x, y, yaw = _text(value, "name"), value.get("x"), value.get("y", 0.0), value.get("yaw")
    if x is None:
        if not name:
            raise BadPatrolError("each place: a name or x and y")
        return PatrolStop(name)
    if not _is_number(x, _FARTHEST) or not _is_number(y, _FARTHEST) or not (yaw is None or _is_number(yaw, 7.0)):
        raise BadPatrolError("x, y: metres in the map; yaw: rad, or none")
    return PatrolStop(name, float(x), float(y), None if yaw is None else float(yaw))


def _text(value: Mapping[str, Any], key: str, longest: int = LONGEST_NAME) -> str:
    found = value.get(key, "")
    if not isinstance(found, str) or len(found) > longest or not (found.isprintable() or not found):
        raise BadPatrolError(f"{key}: a printable text of at most {longest} characters")
    return found


def _is_number(value: object, most: float) -> bool:
    good = isinstance(value, (int, float)) and not isinstance(value, bool)
    return good and math.isfinite(float(cast("float", value))) and abs(float(cast("float", value))) <= most


def _is_count(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**32


def _read_object(text: object) -> dict[str, Any]:
    if not isinstance(text, str) or len(text) > _LONGEST:
        raise BadPatrolError(f"a text of at most {_LONGEST} characters")
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        raise BadPatrolError("JSON") from None
    if not isinstance(value, dict):
        raise BadPatrolError("a JSON object")
    return value
