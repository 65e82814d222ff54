"""The heart of a run: what to do when something happens. Pure: no process, no clock, no network.

`step(state, event, now)` returns the next state and what has to be done. The shell around it (`ur.run.loop`) carries
the actions out and feeds back what happens.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from signal import SIGINT, SIGKILL, SIGTERM

from ur.run.model import (
    Action,
    AwaitMaster,
    Begin,
    Event,
    Exited,
    ExitStatus,
    Finish,
    Limits,
    MasterAnswered,
    NothingLeft,
    ParametersSet,
    Phase,
    SetParameters,
    SetupFailed,
    Signal,
    Start,
    Started,
    StartFailed,
    State,
    Status,
    StopRequested,
    Sweep,
    TellDeath,
    TellPressure,
    TellStop,
    Tick,
    Unit,
    UnitState,
    Unregister,
    Unregistered,
)

_ORDER = list(Phase)
_SIGNALS = (SIGINT, SIGTERM, SIGKILL)
_Step = tuple[State, list[Action]]


def begin_state(units: Iterable[Unit], *, own_master: bool, limits: Limits | None = None) -> State:
    """The state before anything happened. Units start in this order, core units first and terminal units last."""
    ordered = sorted(units, key=lambda unit: (not unit.core, unit.terminal))
    return State(tuple(UnitState(unit) for unit in ordered), own_master, limits or Limits())


def step(state: State, event: Event, now: float) -> tuple[State, tuple[Action, ...]]:
    """What follows from an event. `now` is any clock that never goes back, in s."""
    following, actions = _handle(state, event, now)
    return following, tuple(actions)


def next_deadline(state: State) -> float | None:
    """When `Tick` is due at the latest; None when only events matter."""
    times = [each.due for each in state.units if each.due is not None and state.phase is Phase.RUNNING]
    if state.deadline is not None:
        times.append(state.deadline)
    return min(times, default=None)


def _handle(state: State, event: Event, now: float) -> _Step:
    if state.phase is Phase.DONE:
        return state, []
    match event:
        case Started(name, pid):
            return _started(state, name, pid, now)
        case StartFailed(name, reason):
            return _ended(state, name, ExitStatus(), now, reason)
        case Exited(name, status):
            return _ended(state, name, status, now)
        case StopRequested(cause, exit_code):
            if _before(state, Phase.STOPPING_NODES):
                return _stop(state, cause, exit_code, now)
            return _press(state, now)
        case Tick():
            return _tick(state, now)
    return _proceed(state, event, now)


def _proceed(state: State, event: Event, now: float) -> _Step:
    """From phase to phase: each of these events belongs to one phase and means nothing in another."""
    match event:
        case Begin() if state.phase is Phase.MASTER:
            return _begin(state, now)
        case MasterAnswered() if state.phase is Phase.MASTER:
            started, actions = _start(state, (each for each in state.units if each.unit.core), now)
            return replace(started, phase=Phase.PARAMETERS, deadline=None), [*actions, SetParameters()]
        case ParametersSet() if state.phase is Phase.PARAMETERS:
            running = replace(state, phase=Phase.RUNNING)
            return _start(running, (each for each in running.units if not each.unit.core), now)
        case SetupFailed(reason) if _before(state, Phase.STOPPING_NODES):
            return _stop(state, reason, 1, now, failed=True)
        case NothingLeft() if state.phase is Phase.SWEEPING:
            return _unregister(state, now)
        case Unregistered() if state.phase is Phase.UNREGISTERING:
            return _finish(state)
    return state, []


def _begin(state: State, now: float) -> _Step:
    if not state.own_master:
        return replace(state, phase=Phase.PARAMETERS), [SetParameters()]
    first = next(each for each in state.units if each.unit.core)
    started, actions = _start(state, [first], now)
    return replace(started, deadline=now + state.limits.master), [*actions, AwaitMaster()]


def _start(state: State, chosen: Iterable[UnitState], now: float) -> _Step:
    actions: list[Action] = []
    for each in chosen:
        if each.status is Status.WAITING:
            state = _put(state, replace(each, status=Status.STARTING, since=now, due=None))
            actions.append(Start(each.unit.name))
    return state, actions


def _started(state: State, name: str, pid: int, now: float) -> _Step:
    each = state.find(name)
    if each is None or each.status is not Status.STARTING:
        return state, []
    state = _put(state, replace(each, status=Status.RUNNING, pid=pid, since=now))
    if state.pressure and not (each.unit.core and state.phase is Phase.STOPPING_NODES):
        return state, [Signal(name, _SIGNALS[state.pressure - 1])]  # asked for before the stop, there only now
    return state, []


def _ended(state: State, name: str, status: ExitStatus, now: float, reason: str | None = None) -> _Step:
    each = state.find(name)
    if each is None or not each.alive:
        return state, []
    lived = now - each.since if each.status is Status.RUNNING else 0.0
    each = replace(each, status=Status.ENDED, pid=None, since=now, exit=status)
    state = _put(state, each)
    if not _before(state, Phase.STOPPING_NODES):
        return _advance(state, now)
    unit = each.unit
    if unit.terminal or unit.required:
        code = status.shell_code if unit.terminal else int(not status.clean)
        # A program on the terminal has said itself why it ends, unless it was killed.
        quiet = unit.terminal and (status.code is not None or status.signal == SIGINT)
        told: list[Action] = [] if quiet else [TellDeath(name, status, reason, ends_run=True)]
        state, actions = _stop(state, "" if unit.terminal else f"{name} is required and has ended", code, now)
        return state, told + actions
    if unit.respawn:
        quick = each.quick_deaths + 1 if lived < state.limits.quick_death else 0
        delay = max(unit.respawn_delay, _backoff(quick, state.limits))
        again = replace(each, status=Status.WAITING, due=now + delay, quick_deaths=quick, restarts=each.restarts + 1)
        return _put(state, again), [TellDeath(name, status, reason, restart_in=delay)]
    told = [TellDeath(name, status, reason)]
    nodes = [other for other in state.units if not other.unit.core]
    if state.phase is Phase.RUNNING and all(other.status is Status.ENDED for other in nodes):
        failed = any(other.exit == ExitStatus() for other in nodes)  # as roslaunch: only what never started counts
        state, actions = _stop(state, "every node has ended", int(failed), now)
        return state, told + actions
    return state, told


def _backoff(quick_deaths: int, limits: Limits) -> float:
    # The first restart is as prompt as roslaunch's; only a unit that keeps dying is slowed down.
    return 0.0 if quick_deaths < 2 else min(limits.longest_backoff, 0.25 * 2.0 ** min(quick_deaths - 2, 16))


def _tick(state: State, now: float) -> _Step:
    if state.phase is Phase.RUNNING:
        return _start(state, (each for each in state.units if each.due is not None and each.due <= now), now)
    if state.deadline is None or now < state.deadline:
        return state, []
    if state.phase is Phase.MASTER:
        return _stop(state, f"the master did not answer within {state.limits.master:g} s", 1, now, failed=True)
    return _press(state, now)


def _stop(state: State, cause: str, exit_code: int, now: float, *, failed: bool = False) -> _Step:
    state = replace(state, phase=Phase.STOPPING_NODES, exit_code=exit_code, cause=cause, pressure=0, deadline=None)
    for each in state.units:
        if each.status is Status.WAITING:
            state = _put(state, replace(each, status=Status.ENDED, due=None))
    told: list[Action] = [TellStop(cause, failed)] if cause else []
    state, actions = _advance(state, now)
    return state, told + actions


def _advance(state: State, now: float) -> _Step:
    """Go on with the stop once nothing of this phase is left; send the first signal where that has not happened."""
    if state.phase is Phase.STOPPING_NODES:
        if any(each.alive for each in state.units if not each.unit.core):
            return (state, []) if state.pressure else _press(state, now)
        state = replace(state, phase=Phase.STOPPING_CORE, pressure=0, deadline=None)
    if state.phase is Phase.STOPPING_CORE:
        left = [each for each in state.units if each.alive]
        if left:
            # The last core unit first: rosout says goodbye to a master that is still there.
            if state.pressure > 1:
                return state, []
            deadline = state.deadline or now + state.limits.core
            return replace(state, pressure=1, deadline=deadline), [Signal(left[-1].unit.name, SIGINT)]
        state = replace(state, phase=Phase.SWEEPING, pressure=2, deadline=now + state.limits.sweep)
        return state, [Sweep(SIGTERM)]
    return state, []


def _press(state: State, now: float) -> _Step:
    """The next, stronger signal; or the next phase where there is none stronger."""
    if state.phase is Phase.STOPPING_NODES:
        left = tuple(each.unit.name for each in state.units if each.alive and not each.unit.core)
        if state.pressure >= len(_SIGNALS):
            return _abandon(state, now)
        signum = _SIGNALS[state.pressure]
        wait = (state.limits.interrupt, state.limits.terminate, 1.0)[state.pressure]
        told: list[Action] = [TellPressure(left, signum)] if state.pressure else []
        state = replace(state, pressure=state.pressure + 1, deadline=now + wait)
        return state, told + [Signal(name, signum) for name in left]
    if state.phase is Phase.STOPPING_CORE:
        left = tuple(each.unit.name for each in state.units if each.alive)
        if state.pressure >= len(_SIGNALS):
            return _abandon(state, now)
        state = replace(state, pressure=len(_SIGNALS), deadline=now + 1.0)
        return state, [Signal(name, SIGKILL) for name in left]
    if state.phase is Phase.SWEEPING:
        if state.pressure >= len(_SIGNALS):
            return _unregister(state, now)
        return replace(state, pressure=len(_SIGNALS), deadline=now + 1.0), [Sweep(SIGKILL)]
    return _finish(state)


def _abandon(state: State, now: float) -> _Step:
    """Nothing survives SIGKILL except a process that hangs in the kernel: wait no longer for it."""
    for each in state.units:
        if each.alive and each.unit.core == (state.phase is Phase.STOPPING_CORE):
            state = _put(state, replace(each, status=Status.ENDED, pid=None))
    return _advance(state, now)


def _unregister(state: State, now: float) -> _Step:
    if state.own_master:
        return _finish(state)
    return replace(state, phase=Phase.UNREGISTERING, deadline=now + state.limits.unregister), [Unregister()]


def _finish(state: State) -> _Step:
    return replace(state, phase=Phase.DONE, deadline=None), [Finish(state.exit_code)]


def _before(state: State, phase: Phase) -> bool:
    return _ORDER.index(state.phase) < _ORDER.index(phase)


def _put(state: State, changed: UnitState) -> State:
    name = changed.unit.name
    return replace(state, units=tuple(changed if each.unit.name == name else each for each in state.units))
