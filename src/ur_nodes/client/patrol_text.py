"""A patrol and requests for one: values, JSON as it travels, sentences. What comes from a network is checked here."""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal

from msgspec import Meta

from ur.source.foreign.json_values import BadJsonError, Count, PrintableValue, Stamp, read_json, write_json
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality

PatrolState = Literal["idle", "starting", "driving", "waiting", "paused", "done", "ended"]
PatrolAction = Literal["start", "pause", "resume", "end"]

MOST_PLACES = 50
LONGEST_NAME = 64
LONGEST_WAIT = 3600.0
"""Seconds at a place."""

_LONGEST = 16384  # characters
_FARTHEST = 1e5  # m
ACTIVE: tuple[PatrolState, ...] = ("starting", "driving", "waiting")


_Name = Annotated[str, Meta(max_length=LONGEST_NAME)]
_Reason = Annotated[str, Meta(max_length=500)]
_Metres = Annotated[float, Meta(ge=-_FARTHEST, le=_FARTHEST)]
_PLACES = f"1 to {MOST_PLACES} names or poses in the map: x, y in m, yaw in rad or none"


@dataclass(frozen=True, slots=True)
class PatrolStop:
    """A place of a patrol in the map: m, m, rad. Without `yaw` any heading counts.

    `x` is None in a request by name: the robot looks the place up among its waypoints.
    """

    name: _Name = ""
    x: _Metres | None = None
    y: _Metres = 0.0
    yaw: Annotated[float, Meta(ge=-7.0, le=7.0)] | None = None


@dataclass(frozen=True, slots=True)
class PatrolRoute:
    """Places in their order; `wait` s at each; `loop`: again from the first after the last."""

    stops: tuple[PatrolStop, ...] = ()
    loop: bool = False
    wait: float = 1.0


@dataclass(frozen=True, slots=True)
class PatrolAnswer:
    """The answer to a request by its id; `problem` is '' when it was accepted."""

    id: _Name
    problem: _Reason = ""


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
        """Return the stop to which the robot drives, or at which it waits."""
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


class _WireRoute(PrintableValue, frozen=True, forbid_unknown_fields=False):
    places: Annotated[tuple[_Name | PatrolStop, ...], Meta(max_length=MOST_PLACES, description=_PLACES)] = ()
    loop: bool = False
    wait: Annotated[float, Meta(ge=0.0, le=LONGEST_WAIT, description=f"seconds from 0 to {LONGEST_WAIT:g}")] = 1.0

    def route(self) -> PatrolRoute:
        """Return the route. Raises BadJsonError."""
        stops = tuple(PatrolStop(each) if isinstance(each, str) else each for each in self.places)
        if not stops or any(not each.name and each.x is None for each in stops):
            raise BadJsonError(f"places: expected {_PLACES}")
        return PatrolRoute(stops, self.loop, self.wait)


class _WireRequest(_WireRoute, frozen=True, kw_only=True):
    do: PatrolAction
    id: _Name = ""
    client: _Name = ""
    name: _Name = ""
    answers: Stamp | None = None


class _WireStatus(_WireRoute, frozen=True, kw_only=True):
    state: PatrolState
    index: Count
    rounds: Count
    reason: _Reason = ""
    answer: PatrolAnswer | None = None


def write_request(request: PatrolRequest) -> str:
    """Return the request as JSON."""
    route, client = request.route, request.client if request.answers is not None else ""
    return write_json(
        _WireRequest(
            route.stops, route.loop, route.wait,
            do=request.action, id=request.id, client=client, name=request.name, answers=request.answers,
        )
    )  # fmt: skip


def read_request(text: object) -> PatrolRequest:
    """Parse a request. Raises BadJsonError."""
    found = read_json(text, _WireRequest, _LONGEST)
    route = found.route() if found.do == "start" else PatrolRoute()
    if found.answers is None:
        return PatrolRequest(found.do, route, found.id, "", found.name)
    if not found.client:
        raise BadJsonError("client: expected the id of a client, beside its answers")
    return PatrolRequest(found.do, route, found.id, found.client, found.name, found.answers)


def write_status(status: PatrolStatus) -> str:
    """Return the status as JSON, one object."""
    route = status.route
    return write_json(
        _WireStatus(
            route.stops, route.loop, route.wait,
            state=status.state, index=status.index, rounds=status.rounds, reason=status.reason, answer=status.answer,
        )
    )  # fmt: skip


def read_status(text: object) -> PatrolStatus | None:
    """Parse the status of a message; None if it is malformed."""
    try:
        found = read_json(text, _WireStatus, _LONGEST)
        route = found.route() if found.places else PatrolRoute()
    except BadJsonError:
        return None
    return PatrolStatus(found.state, route, found.index, found.rounds, found.reason, found.answer)


def describe_patrol(status: PatrolStatus) -> str:
    """Describe a patrol in one line; '' while there is none."""
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
    """Return the name of the place, or else its coordinates, for users."""
    return stop.name or f"({stop.x or 0.0:.2f}, {stop.y:.2f})"


_MOST_WAITING = 20


class PatrolLink:
    """Shows the patrol and passes requests on. Reads may come from any thread."""

    def __init__(self, node: Node, patrol: str = "patrol") -> None:
        """`patrol` is the name of the node that drives the patrol."""
        self._node = node
        self._status = PatrolStatus()
        self._waiting: OrderedDict[str, Callable[[str], None]] = OrderedDict()
        self._requests = node.publish(f"{patrol}/request", str, Quality.EVERY)
        self._statuses = node.subscribe(f"{patrol}/status", str, self._on_text, Quality.LATCHED)

    def status(self) -> PatrolStatus | None:
        """Return the newest status; None without a patrol node."""
        return self._status if self._statuses.publishers() else None

    def served(self) -> bool:
        """Return whether a node takes requests."""
        return self._requests.subscribers() > 0

    def request(self, request: PatrolRequest, done: Callable[[str], None] | None = None) -> bool:
        """Publish a request; `done` is called with the refusal, or ''. Return False without a patrol node."""
        if not self.served():
            return False
        if done is not None:
            self._waiting[request.id] = done
            while len(self._waiting) > _MOST_WAITING:
                self._waiting.popitem(last=False)
        self._requests.send(write_request(request))
        return True

    def _on_text(self, text: str) -> None:
        status = read_status(text)
        if status is None:
            self._node.log.warn("the status of the patrol cannot be read and is not shown", every=10.0)
            return
        self._status = status
        done = self._waiting.pop(status.answer.id, None) if status.answer else None
        if done is not None and status.answer is not None:
            done(status.answer.problem)
