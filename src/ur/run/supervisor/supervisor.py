"""The pure core of a run: the actions that follow an event. It has no process, no clock and no network.

`step(state, event, now)` returns the next state and the actions. The shell around it (`ur.run.loop`) executes the
actions and passes events back. `lifecycle` handles the start and the end of one unit, `requests` those of clients, and
`shutdown` the end of the whole run.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from ur.run.supervisor.actions import (
    Action,
    AwaitMaster,
    ReportLink,
    ReportMaster,
    ReportRevival,
    SetParameters,
    StartShare,
    Step,
    is_before,
    start_units,
)
from ur.run.supervisor.events import (
    Begin,
    Event,
    Evicted,
    Exited,
    KillNode,
    LinkLost,
    LinkRestored,
    MasterAnswered,
    MasterLost,
    MasterReplaced,
    MasterReturned,
    NothingLeft,
    OwnerEnded,
    ParametersSet,
    RestartNode,
    RobotMasterLost,
    SetupFailed,
    ShareFailed,
    ShareStarted,
    Started,
    StartFailed,
    StartNode,
    StopNode,
    StopRequested,
    Tick,
    Unregistered,
)
from ur.run.supervisor.lifecycle import note_ended, note_started
from ur.run.supervisor.requests import apply_request, press_overdue, restart_all
from ur.run.supervisor.shutdown import begin_end, finish_end, press_all, remove_registrations
from ur.run.supervisor.state import ExitStatus, RunPhase, State, TimeLimits, Unit, UnitState


def begin_state(
    units: Iterable[Unit], *, own_master: bool, limits: TimeLimits | None = None, shared: bool = False
) -> State:
    """Return the initial state. Units start in this order, core units first and terminal units last."""
    ordered = sorted(units, key=lambda unit: (not unit.core, unit.terminal))
    places = {unit.name: place for place, unit in enumerate(ordered)}
    return State(
        tuple(UnitState(unit) for unit in ordered), own_master, limits or TimeLimits(), shared=shared, places=places
    )


def step(state: State, event: Event, now: float) -> tuple[State, tuple[Action, ...]]:
    """Compute the next state and the actions for an event. `now` is any monotonic clock, in s."""
    following, actions = _handle(state, event, now)
    return following, tuple(actions)


def next_deadline(state: State) -> float | None:
    """Return the latest time at which `Tick` is due; None if only events matter."""
    times = []
    if state.phase is RunPhase.RUNNING and not state.reviving:
        times = [each.due for each in state.units if each.due is not None]
    if is_before(state, RunPhase.STOPPING_NODES):
        times += [each.deadline for each in state.units if each.deadline is not None]
    if state.deadline is not None:
        times.append(state.deadline)
    return min(times, default=None)


def _handle(state: State, event: Event, now: float) -> Step:
    if state.phase is RunPhase.DONE:
        return state, []
    match event:
        case Started(name, pid):
            return note_started(state, name, pid, now)
        case StartFailed(name, reason):
            return note_ended(state, name, ExitStatus(), now, reason)
        case Exited(name, status):
            return note_ended(state, name, status, now)
        case Evicted(name, status, by):
            return note_ended(state, name, status, now, evicted_by=by)
        case OwnerEnded(cause):
            return (
                begin_end(state, cause, 1, now, failed=True)
                if is_before(state, RunPhase.STOPPING_NODES)
                else (state, [])
            )
        case StopRequested(cause, exit_code):
            if is_before(state, RunPhase.STOPPING_NODES):
                return begin_end(state, cause, exit_code, now)
            return press_all(state, now)
        case StartNode() | StopNode() | RestartNode() | KillNode():
            return apply_request(state, event, now)
        case Tick():
            return _tick(state, now)
    return _proceed(state, event, now)


def _proceed(state: State, event: Event, now: float) -> Step:
    """Advance from phase to phase: each of these events belongs to one phase and is ignored in others."""
    match event:
        case Begin() if state.phase is RunPhase.MASTER:
            return _begin(state, now)
        case MasterAnswered() if state.phase is RunPhase.MASTER:
            started, actions = start_units(state, (each for each in state.units if each.unit.core), now)
            return replace(started, phase=RunPhase.PARAMETERS, deadline=None), [*actions, SetParameters()]
        case ParametersSet() if state.phase is RunPhase.PARAMETERS:
            running = replace(state, phase=RunPhase.RUNNING)
            return start_units(running, (each for each in running.units if not each.unit.core), now)
        case ParametersSet() if state.reviving:
            return restart_all(state, now)
        case SetupFailed() if state.reviving:
            # The master has ended again; its monitor reports a new one
            return replace(state, reviving=False, stale=True), []
        case SetupFailed(reason) if is_before(state, RunPhase.STOPPING_NODES):
            return begin_end(state, reason, 1, now, failed=True)
        case NothingLeft() if state.phase is RunPhase.SWEEPING:
            return remove_registrations(state, now)
        case Unregistered() if state.phase is RunPhase.UNREGISTERING:
            return finish_end(state)
        case _ if state.phase is RunPhase.RUNNING:
            return follow_master(state, event, now)
    return state, []


def _begin(state: State, now: float) -> Step:
    if not state.own_master:
        return replace(state, phase=RunPhase.PARAMETERS), [SetParameters()]
    first = next(each for each in state.units if each.unit.core)
    started, actions = start_units(state, [first], now)
    return replace(started, deadline=now + state.limits.master), [*actions, AwaitMaster()]


def _tick(state: State, now: float) -> Step:
    if is_before(state, RunPhase.STOPPING_NODES):
        pressed, actions = press_overdue(state, now)
        if actions:
            return pressed, actions
        state = pressed
    if state.phase is RunPhase.RUNNING:
        due = (each for each in state.units if each.due is not None and each.due <= now)
        return (state, []) if state.reviving else start_units(state, due, now)
    if state.deadline is None or now < state.deadline:
        return state, []
    if state.phase is RunPhase.MASTER:
        return begin_end(state, f"the master did not answer within {state.limits.master:g} s", 1, now, failed=True)
    return press_all(state, now)


def follow_master(state: State, event: Event, now: float) -> Step:
    """React to an event of the master or of the link.

    A lost link alone changes nothing: nodes continue. Another master has neither parameters nor nodes. A robot with a
    share of the run restarts that first.
    """
    match event:
        case LinkLost(seconds):
            return state, [ReportLink(lost=True, seconds=seconds)]
        case LinkRestored(seconds):
            state, actions = _set_stale_parameters(state)
            return state, [ReportLink(lost=False, seconds=seconds), *actions]
        case MasterLost():
            return state, [ReportMaster(lost=True)]
        case MasterReturned():
            state, actions = _set_stale_parameters(state)
            return state, [ReportMaster(lost=False), *actions]
        case MasterReplaced() | RobotMasterLost() if state.shared:
            if state.reviving:
                return state, []  # the master started by the robot's share is detected here, too
            return replace(state, reviving=True), [ReportRevival(), StartShare()]
        case MasterReplaced():
            return replace(state, reviving=True, stale=False), [ReportRevival(), SetParameters()]
        case RobotMasterLost(seconds) if seconds >= state.limits.robot:
            cause = f"the robot answers, but no ROS master has run on it for {seconds:.0f} s"
            return begin_end(state, cause, 1, now, failed=True)
        case ShareStarted() if state.reviving:
            return state, [SetParameters()]
        case ShareFailed(reason) if state.reviving:
            return begin_end(state, reason, 1, now, failed=True)
    return state, []


def _set_stale_parameters(state: State) -> Step:
    if not state.stale or state.reviving:
        return state, []
    return replace(state, reviving=True, stale=False), [ReportRevival(), SetParameters()]
