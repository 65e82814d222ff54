"""The patrol as a state machine without clock or topics: drive to a place, wait, drive to the next.

Nothing starts late. A goal is sent within `LATEST` seconds of the request that asked for it, or of the end of the wait
before it; what cannot be sent by then pauses the patrol, and only another request resumes it. A program that did not
run for `STALLED` seconds (a computer that was suspended) pauses it, too: navigation may have held its goal meanwhile.
"""

import os
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

from ur.source.diagnostic import UserError
from ur_nodes.client.patrol_text import PatrolAnswer, PatrolRoute, PatrolStatus, PatrolStop, name_stop
from ur_nodes.client.snapshot import LastGoalState
from ur_nodes.client.waypoints import PlaceSettings, WaypointStore, choose_file, read_settings
from ur_nodes.geometry.grid import Grid
from ur_nodes.motion.lease.text import LEASE_TIMEOUT
from ur_nodes.ports.node import Node, Subscription, Timer
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map

_MAP_WAIT = 2.0  # s
_MOST_WAITING = 10  # routes
TOO_MANY = "expected fewer requests at once"
NO_ANSWER = "expected a parameter server that answers"
NO_MAP = "expected a map, whose waypoints have names"
NO_NAME = "expected a map that has been saved under a name, whose waypoints have names"

Take = Callable[[PatrolRoute | str], None]
"""Takes a route with all poses, or why there is none."""


class PlaceLookup:
    """Looks up the places of routes, one route after the other."""

    def __init__(self, node: Node, keeper: str) -> None:
        """The parameters of the node `keeper` lead to the file of waypoints."""
        self._node, self._keeper = node, keeper
        self._waiting: deque[tuple[PatrolRoute, Take]] = deque()  # the first is being looked up
        self._map: Subscription | None = None
        self._late: Timer | None = None

    def find(self, route: PatrolRoute, callback: Take) -> None:
        """Look up the places of a route, after those of earlier routes, and pass the result to `callback`.

        Of more than _MOST_WAITING waiting requests, the oldest is dropped.
        """
        self._waiting.append((route, callback))
        if len(self._waiting) == 1:
            self._begin()
        elif len(self._waiting) > 1 + _MOST_WAITING:
            _, give_up = self._waiting[1]
            del self._waiting[1]
            give_up(TOO_MANY)

    def _begin(self) -> None:
        route, _ = self._waiting[0]
        if all(stop.x is not None for stop in route.stops):
            self._finish(route)
            return
        keeper = self._node.parameters.of(self._keeper)

        def read() -> PlaceSettings | str:
            names = ("map_name", "waypoints_file", "save_service")
            try:
                return read_settings({name: keeper.any(name) for name in names})
            except Exception:  # a parameter server may answer anything, or nothing
                return NO_ANSWER

        self._node.work(read, self._on_settings, "places")

    def _on_settings(self, settings: PlaceSettings | str) -> None:
        if isinstance(settings, str):
            self._finish(settings)
            return
        if settings.file or settings.map_name:
            self._look_up(settings, None)
            return
        take = partial(self._on_map, settings)
        self._map = self._node.subscribe("map", Map, take, Quality.LATCHED, unreadable=take)
        self._late = self._node.after(_MAP_WAIT, partial(take, NO_MAP), steady=True)

    def _on_map(self, settings: PlaceSettings, found: Map | str) -> None:
        """Take the map, or the reason why there is none."""
        if self._map is None or self._late is None:
            return
        self._map.close()
        self._late.cancel()
        self._map = self._late = None
        if isinstance(found, str):
            self._finish(found)
        else:
            self._look_up(settings, found.grid)

    def _look_up(self, settings: PlaceSettings, grid: Grid | None) -> None:
        route, _ = self._waiting[0]
        self._node.work(lambda: look_up(route, settings, grid), self._finish, "places")

    def _finish(self, found: PatrolRoute | str) -> None:
        _, take = self._waiting.popleft()
        take(found)
        if self._waiting:
            self._begin()


def look_up(route: PatrolRoute, settings: PlaceSettings, grid: Grid | None) -> PatrolRoute | str:
    """Return the route with all poses, or the reason why not; `grid` is the map if the settings name none."""
    path = choose_file(settings, grid, os.environ)
    if path is None:
        return NO_NAME
    store = WaypointStore(path)
    try:
        return replace(route, stops=tuple(_find(store, stop) for stop in route.stops))
    except UserError as problem:
        return problem.diagnostics[0].message


def _find(store: WaypointStore, stop: PatrolStop) -> PatrolStop:
    return stop if stop.x is not None else PatrolStop(stop.name, *store.find(stop.name))


LATEST = 5.0
"""Seconds after which a goal is not sent any more, and in which navigation has to take it."""
STALLED = LEASE_TIMEOUT - 0.5
"""Seconds; navigation holds the goal of a client that is silent for longer, and nothing continues it but a request."""


@dataclass(frozen=True, slots=True)
class PatrolInputs:
    """The world now (s of a steady clock).

    `may_drive`: the patrol has the lease, or the mux has none; `other`: who has it else. `ready`: a goal can be sent.
    `stopped`: the emergency stop is on. `goal`: the state of the goal that was sent last, and its text; None:
    navigation has not mentioned it.
    """

    now: float
    may_drive: bool
    ready: bool
    other: str = ""
    stopped: bool = False
    goal: LastGoalState | None = None
    text: str = ""


@dataclass(frozen=True, slots=True)
class Patrol:
    """The state. `since` (s) when the present state began, or should have; `stepped` when it was stepped last.

    `driven`: the lease was the patrol's since it has started.
    """

    status: PatrolStatus = field(default_factory=PatrolStatus)
    since: float = 0.0
    stepped: float = 0.0
    driven: bool = False


@dataclass(frozen=True, slots=True)
class NavigationCommands:
    """Commands for navigation: `send` a goal, `cancel` the one that was sent."""

    send: PatrolStop | None = None
    cancel: bool = False


NOTHING = NavigationCommands()


def start_patrol(patrol: Patrol, route: PatrolRoute, now: float) -> Patrol:
    """Begin a route; it replaces the last one."""
    return Patrol(PatrolStatus("starting", route, answer=patrol.status.answer), now, now)


def resume_patrol(patrol: Patrol, now: float) -> Patrol:
    """Continue with the last place; a patrol that is not paused is unchanged."""
    return _enter(replace(patrol, driven=False), "starting", now, now) if patrol.status.state == "paused" else patrol


def pause_patrol(patrol: Patrol, reason: str, now: float) -> tuple[Patrol, NavigationCommands]:
    """Pause at the next step, until a request to resume; a patrol that is not active is unchanged."""
    if not patrol.status.active:
        return patrol, NOTHING
    return _enter(patrol, "paused", now, now, reason), NavigationCommands(cancel=True)


def end_patrol(patrol: Patrol, reason: str, now: float) -> tuple[Patrol, NavigationCommands]:
    """End the patrol; one that has ended is unchanged."""
    if not (patrol.status.active or patrol.status.state == "paused"):
        return patrol, NOTHING
    return _enter(patrol, "ended", now, now, reason), NavigationCommands(cancel=patrol.status.active)


def answer_request(patrol: Patrol, answer: PatrolAnswer) -> Patrol:
    """Publish an answer with the status."""
    return replace(patrol, status=replace(patrol.status, answer=answer))


def step_patrol(patrol: Patrol, inputs: PatrolInputs, step_limit: float) -> tuple[Patrol, NavigationCommands]:
    """Return the next state and the commands. `step_limit` (s) is the longest drive to a place."""
    before, now = patrol, inputs.now
    patrol = replace(patrol, stepped=now, driven=patrol.driven or inputs.may_drive)
    if not patrol.status.active:
        return patrol, NOTHING
    if now - before.stepped > STALLED:
        return pause_patrol(patrol, f"the program stood still for {now - before.stepped:.0f} s", now)
    if inputs.stopped:
        return pause_patrol(patrol, "emergency stop", now)
    if inputs.other and patrol.driven and not inputs.may_drive:
        return pause_patrol(patrol, f"{inputs.other} took over", now)
    step = {"starting": _start, "driving": _drive, "waiting": _wait}[patrol.status.state]
    return step(patrol, inputs, step_limit)


def _start(patrol: Patrol, inputs: PatrolInputs, _limit: float) -> tuple[Patrol, NavigationCommands]:
    now = inputs.now
    if now - patrol.since > LATEST:
        why = f"{inputs.other} drives" if inputs.other else "navigation and mux do not answer"
        return pause_patrol(patrol, f"not sent within {LATEST:g} s: {why}", now)
    if not (inputs.may_drive and inputs.ready):
        return patrol, NOTHING
    return _enter(patrol, "driving", now, now), NavigationCommands(send=patrol.status.stop)


def _drive(patrol: Patrol, inputs: PatrolInputs, limit: float) -> tuple[Patrol, NavigationCommands]:
    now, name = inputs.now, name_stop(patrol.status.stop)
    if inputs.goal is LastGoalState.REACHED:
        return _enter(patrol, "waiting", now, now), NOTHING
    if inputs.goal is LastGoalState.FAILED:
        return pause_patrol(patrol, f"{name} was not reached: {inputs.text}", now)
    if inputs.goal is LastGoalState.STOPPED:
        return pause_patrol(patrol, inputs.text or "cancelled", now)
    if inputs.goal is None and now - patrol.since > LATEST:
        return pause_patrol(patrol, f"navigation did not take the goal within {LATEST:g} s", now)
    if now - patrol.since > limit:
        return pause_patrol(patrol, f"{name} was not reached within {limit:g} s", now)
    return patrol, NOTHING


def _wait(patrol: Patrol, inputs: PatrolInputs, limit: float) -> tuple[Patrol, NavigationCommands]:
    status, due = patrol.status, patrol.since + patrol.status.route.wait
    if inputs.now < due:
        return patrol, NOTHING
    last = status.index + 1 >= len(status.route.stops)
    if last and not status.route.loop:
        return _enter(patrol, "done", inputs.now, inputs.now), NOTHING
    following = replace(status, index=0 if last else status.index + 1, rounds=status.rounds + int(last))
    return _start(_enter(replace(patrol, status=following), "starting", due, inputs.now), inputs, limit)


def _enter(patrol: Patrol, state: str, since: float, now: float, reason: str = "") -> Patrol:
    status = replace(patrol.status, state=state, reason=reason)  # type: ignore[arg-type] # callers name states
    return replace(patrol, status=status, since=since, stepped=now)
