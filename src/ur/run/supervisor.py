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
    MasterLost,
    MasterReplaced,
    MasterReturned,
    NothingLeft,
    ParametersSet,
    Phase,
    RestartWanted,
    SetParameters,
    SetupFailed,
    Signal,
    Start,
    Started,
    StartFailed,
    StartWanted,
    State,
    Status,
    StopRequested,
    StopWanted,
    Sweep,
    TellDeath,
    TellMaster,
    TellPressure,
    TellRevival,
    TellStop,
    TellWish,
    Tick,
    Unit,
    UnitState,
    Unregister,
    Unregistered,
    Wish,
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
    times = []
    if state.phase is Phase.RUNNING and not state.reviving:
        times = [each.due for each in state.units if each.due is not None]
    if _before(state, Phase.STOPPING_NODES):
        times += [each.deadline for each in state.units if each.deadline is not None]
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
        case StartWanted(name) | StopWanted(name) | RestartWanted(name):
            return _wish(state, name, event, now)
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
        case MasterLost() | MasterReturned() if state.phase is Phase.RUNNING:
            return state, [TellMaster(lost=isinstance(event, MasterLost))]
        case MasterReplaced() if state.phase is Phase.RUNNING:
            return replace(state, reviving=True), [TellRevival(), SetParameters()]
        case ParametersSet() if state.reviving:
            return _revive(state, now)
        case SetupFailed() if state.reviving:
            return replace(state, reviving=False), []  # the master is gone once more; it is looked after
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
            state = _put(state, replace(each, status=Status.STARTING, since=now, due=None, reason="", held=False))
            actions.append(Start(each.unit.name))
    return state, actions


def _started(state: State, name: str, pid: int, now: float) -> _Step:
    each = state.find(name)
    if each is None or each.status is not Status.STARTING:
        return state, []
    state = _put(state, replace(each, status=Status.RUNNING, pid=pid, since=now))
    pressure = 0 if each.unit.core and state.phase is Phase.STOPPING_NODES else state.pressure or each.pressure
    if pressure:
        return state, [Signal(name, _SIGNALS[pressure - 1])]  # asked for before the stop, there only now
    return state, []


def _ended(state: State, name: str, status: ExitStatus, now: float, reason: str | None = None) -> _Step:
    each = state.find(name)
    if each is None or not each.alive:
        return state, []
    lived = now - each.since if each.status is Status.RUNNING else 0.0
    wish = each.wish
    each = replace(
        each,
        status=Status.ENDED,
        pid=None,
        since=now,
        exit=status,
        wish=None,
        pressure=0,
        deadline=None,
        reason=reason or "",
    )
    state = _put(state, each)
    if not _before(state, Phase.STOPPING_NODES):
        return _advance(state, now)
    if wish is not None:
        return _fulfil(state, each, wish, now)
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
        each = replace(each, quick_deaths=quick)
        if not _is_storm(quick, status, state.limits):
            delay = max(unit.respawn_delay, _backoff(quick, state.limits))
            again = replace(each, status=Status.WAITING, due=now + delay, restarts=each.restarts + 1)
            return _put(state, again), [TellDeath(name, status, reason, restart_in=delay)]
        each = replace(each, gave_up=True, reason=reason or f"died {quick} times in a row")
        state = _put(state, each)
        return _end_when_idle(state, [TellDeath(name, status, reason, deaths=quick)], now)
    return _end_when_idle(state, [TellDeath(name, status, reason)], now)


def _end_when_idle(state: State, told: list[Action], now: float) -> _Step:
    """The run ends with its last node, unless a person stopped one and may want it back."""
    nodes = [other for other in state.units if not other.unit.core]
    if state.phase is not Phase.RUNNING or any(other.status is not Status.ENDED or other.held for other in nodes):
        return state, told
    # As roslaunch, which has no limit to respawning: otherwise only what never started counts.
    failed = any(other.exit == ExitStatus() or other.gave_up for other in nodes)
    state, actions = _stop(state, "every node has ended", int(failed), now)
    return state, told + actions


def _is_storm(quick_deaths: int, status: ExitStatus, limits: Limits) -> bool:
    if not limits.quick_deaths:
        return False
    return quick_deaths >= (min(limits.bad_inputs, limits.quick_deaths) if status.code == 2 else limits.quick_deaths)


def _wish(state: State, name: str, event: Event, now: float) -> _Step:
    """What a person wants of one unit. While the run ends nobody can want anything of it any more."""
    each = state.find(name)
    if not _before(state, Phase.STOPPING_NODES):
        return state, []
    if each is None:
        return state, [TellWish(name, "there is no such node in this run")]
    if each.unit.core:
        return state, [TellWish(name, "it belongs to the run itself; stop the run instead")]
    match event:
        case StartWanted():
            if each.alive:
                return (_put(state, replace(each, wish=Wish.RESTART)) if each.wish else state), []
            return _start_anew(state, each, now)
        case RestartWanted() if not each.alive:
            return _start_anew(state, each, now)
    if not each.alive:
        held = replace(each, status=Status.ENDED, due=None, held=True)
        return _put(state, held), [] if each.held else [TellWish(name)]
    wish = Wish.RESTART if isinstance(event, RestartWanted) else Wish.STOP
    pressure = 2 if isinstance(event, StopWanted) and event.kill else each.pressure
    return _press_unit(state, replace(each, wish=wish, pressure=pressure), now)


def _press_unit(state: State, each: UnitState, now: float) -> _Step:
    """The next, stronger signal for a unit that a person wants stopped."""
    if each.pressure >= len(_SIGNALS):
        return _put(state, replace(each, deadline=None)), []  # it hangs in the kernel; the end of the run copes
    wait = (state.limits.interrupt, state.limits.terminate, 1.0)[each.pressure]
    signum = _SIGNALS[each.pressure]
    told: list[Action] = [TellPressure((each.unit.name,), signum)] if each.pressure and each.deadline else []
    state = _put(state, replace(each, pressure=each.pressure + 1, deadline=now + wait))
    if each.status is Status.STARTING:
        return state, told  # it hears the signal once it is there
    return state, [*told, Signal(each.unit.name, signum)]


def _fulfil(state: State, each: UnitState, wish: Wish, now: float) -> _Step:
    if wish is Wish.RESTART:
        again = replace(each, restarts=each.restarts + 1)
        return _start_anew(_put(state, again), again, now)
    return _put(state, replace(each, held=True)), [TellWish(each.unit.name)]


def _start_anew(state: State, each: UnitState, now: float) -> _Step:
    waiting = replace(each, status=Status.WAITING, due=now, quick_deaths=0, gave_up=False, held=False)
    state = _put(state, waiting)
    return _start(state, [waiting], now) if state.phase is Phase.RUNNING and not state.reviving else (state, [])


def _revive(state: State, now: float) -> _Step:
    """Nodes do not register again by themselves: each that runs is restarted, each that was due starts."""
    state = replace(state, reviving=False)
    actions: list[Action] = []
    for each in state.units:
        if each.unit.core:
            continue
        if each.alive and each.wish is None:
            state, more = _press_unit(state, replace(each, wish=Wish.RESTART), now)
            actions += more
    state, more = _start(state, (each for each in state.units if each.due is not None and each.due <= now), now)
    return state, actions + more


def _backoff(quick_deaths: int, limits: Limits) -> float:
    # The first restart is as prompt as roslaunch's; only a unit that keeps dying is slowed down.
    return 0.0 if quick_deaths < 2 else min(limits.longest_backoff, 0.25 * 2.0 ** min(quick_deaths - 2, 16))


def _tick(state: State, now: float) -> _Step:
    if _before(state, Phase.STOPPING_NODES):
        pressed: list[Action] = []
        for each in state.units:
            if each.deadline is not None and each.deadline <= now:
                state, more = _press_unit(state, each, now)
                pressed += more
        if pressed:
            return state, pressed
    if state.phase is Phase.RUNNING:
        if state.reviving:
            return state, []
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
        else:
            state = _put(state, replace(each, wish=None, pressure=0, deadline=None))
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
