"""The patrol as a state machine without clock or topics: drive to a place, wait, drive to the next.

Nothing starts late. A goal is sent within `LATEST` seconds of the request that asked for it, or of the end of the wait
before it; what cannot be sent by then pauses the patrol, and only another request resumes it. A program that did not
run for `STALLED` seconds (a computer that was suspended) pauses it, too: navigation may have held its goal meanwhile.
"""

from dataclasses import dataclass, field, replace

from ur_nodes.client.patrol_text import PatrolAnswer, PatrolRoute, PatrolStatus, PatrolStop, name_stop
from ur_nodes.client.snapshot import LastGoalState
from ur_nodes.motion.lease.text import LEASE_TIMEOUT

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
