"""The pure core of a run: the actions that follow an event. It has no process, no clock and no network.

`step(state, event, now)` returns the next state and the actions. The shell around it (`ur.run.loop`) executes the
actions and passes events back.
"""

from collections.abc import Iterable
from signal import SIGINT, SIGKILL, SIGTERM

from ur.run.supervisor.actions import (
    SIGNALS,
    Action,
    AwaitMaster,
    Finish,
    ReportDeath,
    ReportLink,
    ReportMaster,
    ReportPlanned,
    ReportPressure,
    ReportRequest,
    ReportRevival,
    ReportStop,
    SetParameters,
    SignalUnit,
    StartShare,
    Step,
    Sweep,
    Unregister,
    is_before,
    put_unit,
    signal_patience,
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
    NodeRequest,
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
from ur.run.supervisor.planned import collect_final, note_effects
from ur.run.supervisor.state import (
    Effect,
    EndPlanned,
    ExitStatus,
    Planned,
    PrintPlanned,
    RunPhase,
    State,
    StopRequest,
    TimeLimits,
    Unit,
    UnitState,
    UnitStatus,
)
from ur.source.data_classes import replace


def begin_end(state: State, cause: str, exit_code: int, now: float, *, failed: bool = False) -> Step:
    """End the run. `cause` is a text for the user, '' without one; `failed` means that it could not start."""
    state = replace(state, phase=RunPhase.STOPPING_NODES, exit_code=exit_code, cause=cause, pressure=0, deadline=None)
    for each in state.units:
        if each.status is UnitStatus.WAITING:
            state = put_unit(state, replace(each, status=UnitStatus.ENDED, due=None))
        else:
            state = put_unit(state, replace(each, request=None, pressure=0, deadline=None))
    reported: list[Action] = [ReportStop(cause, failed)] if cause else []
    reported += [ReportPlanned(text) for text in collect_final(state.planned)]
    state, actions = advance_end(replace(state, planned=()), now)
    return state, reported + actions


def advance_end(state: State, now: float) -> Step:
    """Continue with the next phase once no process of this one is left; send the first signal if still necessary."""
    if state.phase is RunPhase.STOPPING_NODES:
        if any(each.alive for each in state.units if not each.unit.core):
            return (state, []) if state.pressure else press_all(state, now)
        state = replace(state, phase=RunPhase.STOPPING_CORE, pressure=0, deadline=None)
    if state.phase is RunPhase.STOPPING_CORE:
        left = [each for each in state.units if each.alive]
        if left:
            # The last core unit first: rosout unregisters from a master that still runs.
            if state.pressure > 1:
                return state, []
            deadline = state.deadline or now + state.limits.core
            return replace(state, pressure=1, deadline=deadline), [SignalUnit(left[-1].unit.name, SIGINT)]
        state = replace(state, phase=RunPhase.SWEEPING, pressure=2, deadline=now + state.limits.sweep)
        return state, [Sweep(SIGTERM)]
    return state, []


def press_all(state: State, now: float) -> Step:
    """Send the next, stronger signal to all remaining processes; continue with the next phase after the strongest."""
    match state.phase:
        case RunPhase.STOPPING_NODES:
            return _press_nodes(state, now)
        case RunPhase.STOPPING_CORE:
            if state.pressure >= len(SIGNALS):
                return _abandon(state, now)
            left = tuple(each.unit.name for each in state.units if each.alive)
            state = replace(state, pressure=len(SIGNALS), deadline=now + 1.0)
            return state, [SignalUnit(name, SIGKILL) for name in left]
        case RunPhase.SWEEPING:
            if state.pressure >= len(SIGNALS):
                return remove_registrations(state, now)
            return replace(state, pressure=len(SIGNALS), deadline=now + 1.0), [Sweep(SIGKILL)]
    return finish_end(state)


def remove_registrations(state: State, now: float) -> Step:
    """Remove registrations from a master that continues, after all processes have ended."""
    if state.own_master:
        return finish_end(state)
    return replace(state, phase=RunPhase.UNREGISTERING, deadline=now + state.limits.unregister), [Unregister()]


def finish_end(state: State) -> Step:
    """Finish the run."""
    return replace(state, phase=RunPhase.DONE, deadline=None), [Finish(state.exit_code)]


def _press_nodes(state: State, now: float) -> Step:
    if state.pressure >= len(SIGNALS):
        return _abandon(state, now)
    left = tuple(each.unit.name for each in state.units if each.alive and not each.unit.core)
    signum = SIGNALS[state.pressure]
    reported: list[Action] = [ReportPressure(left, signum)] if state.pressure else []
    wait = signal_patience(state.limits, state.pressure)
    state = replace(state, pressure=state.pressure + 1, deadline=now + wait)
    return state, reported + [SignalUnit(name, signum) for name in left]


def _abandon(state: State, now: float) -> Step:
    """Stop waiting for a process that hangs in the kernel: only such a process survives SIGKILL."""
    for each in state.units:
        if each.alive and each.unit.core == (state.phase is RunPhase.STOPPING_CORE):
            state = put_unit(state, replace(each, status=UnitStatus.ENDED, pid=None))
    return advance_end(state, now)


def apply_request(state: State, wanted: NodeRequest, now: float) -> Step:
    """Start to execute a request. While the run ends, requests are ignored."""
    if not is_before(state, RunPhase.STOPPING_NODES):
        return state, []
    each = state.find(wanted.name)
    if each is None:
        return state, [ReportRequest(wanted.name, "there is no such node in this run")]
    if each.unit.core:
        return state, [ReportRequest(wanted.name, "it belongs to the run itself; stop the run instead")]
    match wanted:
        case StartNode():
            if each.alive:
                return (put_unit(state, replace(each, request=StopRequest.RESTART)) if each.request else state), []
            return _start_anew(state, each, now)
        case RestartNode() if not each.alive:
            return _start_anew(state, each, now)
    if not each.alive:
        held = replace(each, status=UnitStatus.ENDED, due=None, held=True)
        return put_unit(state, held), [] if each.held else [ReportRequest(wanted.name)]
    request = StopRequest.RESTART if isinstance(wanted, RestartNode) else StopRequest.STOP
    pressure = 2 if isinstance(wanted, KillNode) else each.pressure
    return press_unit(state, replace(each, request=request, pressure=pressure), now)


def press_unit(state: State, each: UnitState, now: float) -> Step:
    """Send the next, stronger signal to a unit that is to stop."""
    if each.pressure >= len(SIGNALS):
        # The process hangs in the kernel; the end of the run handles that
        return put_unit(state, replace(each, deadline=None)), []
    signum = SIGNALS[each.pressure]
    reported: list[Action] = [ReportPressure((each.unit.name,), signum)] if each.pressure and each.deadline else []
    wait = signal_patience(state.limits, each.pressure)
    state = put_unit(state, replace(each, pressure=each.pressure + 1, deadline=now + wait))
    if each.status is UnitStatus.STARTING:
        return state, reported  # it gets the signal once it exists
    return state, [*reported, SignalUnit(each.unit.name, signum)]


def press_overdue(state: State, now: float) -> Step:
    """Send stronger signals to all units that did not stop in time."""
    actions: list[Action] = []
    for each in state.units:
        if each.deadline is not None and each.deadline <= now:
            state, more = press_unit(state, each, now)
            actions += more
    return state, actions


def fulfil_request(state: State, each: UnitState, request: StopRequest, now: float) -> Step:
    """Complete a request after its unit has ended."""
    if request is StopRequest.RESTART:
        again = replace(each, restarts=each.restarts + 1)
        return _start_anew(put_unit(state, again), again, now)
    return put_unit(state, replace(each, held=True)), [ReportRequest(each.unit.name)]


def restart_all(state: State, now: float) -> Step:
    """Restart running and due units after another master has started: nodes do not register again by themselves."""
    state = replace(state, reviving=False)
    actions: list[Action] = []
    for each in state.units:
        if each.alive and each.request is None and not each.unit.core:
            state, more = press_unit(state, replace(each, request=StopRequest.RESTART), now)
            actions += more
    state, more = start_units(state, (each for each in state.units if each.due is not None and each.due <= now), now)
    return state, actions + more


def _start_anew(state: State, each: UnitState, now: float) -> Step:
    waiting = replace(each, status=UnitStatus.WAITING, due=now, quick_deaths=0, gave_up=False, held=False)
    state = put_unit(state, waiting)
    if state.phase is not RunPhase.RUNNING or state.reviving:
        return state, []
    return start_units(state, [waiting], now)


def note_started(state: State, name: str, pid: int, now: float) -> Step:
    """Record that a unit has a process, which gets a signal requested before it existed."""
    each = state.find(name)
    if each is None or each.status is not UnitStatus.STARTING:
        return state, []
    state = put_unit(state, replace(each, status=UnitStatus.RUNNING, pid=pid, since=now))
    pressure = 0 if each.unit.core and state.phase is RunPhase.STOPPING_NODES else state.pressure or each.pressure
    return state, [SignalUnit(name, SIGNALS[pressure - 1])] if pressure else []


def note_ended(state: State, name: str, status: ExitStatus, now: float, reason: str = "", evicted_by: str = "") -> Step:
    """Record that a unit's process has ended, or (`reason`) could not be started.

    A unit that another node's registration has ended (`evicted_by`) is not restarted, since it would end that node in
    turn.
    """
    before = state.find(name)
    if before is None or not before.alive:
        return state, []
    each = replace(
        before,
        status=UnitStatus.ENDED,
        pid=None,
        since=now,
        exit=status,
        request=None,
        pressure=0,
        deadline=None,
        reason=reason or (f"ended by {evicted_by}" if evicted_by else ""),
        gave_up=bool(evicted_by),
    )
    state = put_unit(state, each)
    if not is_before(state, RunPhase.STOPPING_NODES):
        return advance_end(state, now)
    if before.request is not None:
        return fulfil_request(state, each, before.request, now)
    death = ReportDeath(name, status, reason or None, evicted_by=evicted_by)
    if each.unit.terminal or each.unit.required:
        return _end_with(state, each, death, now)
    spent = each.unit.retries is not None and each.restarts >= each.unit.retries
    if each.unit.respawn and not evicted_by and not spent:
        lived = now - before.since if before.status is UnitStatus.RUNNING else 0.0
        return _respawn(state, each, death, lived, now)
    return _end_when_idle(state, [death], now)


def _end_with(state: State, each: UnitState, death: ReportDeath, now: float) -> Step:
    """End the run because of this unit's end."""
    unit, status = each.unit, death.status
    if not unit.terminal:
        # roslaunch exits with 0 then; a run with a program of this project in front has not fulfilled its task.
        counts = unit.core or state.limits.failures_count or any(other.unit.terminal for other in state.units)
        code = int(bool(death.evicted_by) or (counts and not status.clean))
        state, actions = begin_end(state, f"{unit.name} is required and has ended", code, now)
        return state, [replace(death, ends_run=True), *actions]
    state, actions = begin_end(state, "", status.shell_code or int(bool(death.evicted_by)), now)
    if death.evicted_by:
        return state, [replace(death, ends_run=True), *actions]
    if status.code is not None or status.signal == SIGINT:  # then it has already reported the reason of its end
        return state, actions
    return state, [replace(death, ends_run=True), *actions]


def _respawn(state: State, each: UnitState, death: ReportDeath, lived: float, now: float) -> Step:
    """Restart the unit with growing delays; give up if it always dies soon."""
    quick = each.quick_deaths + 1 if lived < state.limits.quick_death else 0
    each = replace(each, quick_deaths=quick)
    if state.limits.is_storm(quick, death.status):
        each = replace(each, gave_up=True, reason=each.reason or f"died {quick} times in a row")
        return _end_when_idle(put_unit(state, each), [replace(death, deaths=quick)], now)
    delay = max(each.unit.respawn_delay, state.limits.backoff(quick))
    again = replace(each, status=UnitStatus.WAITING, due=now + delay, restarts=each.restarts + 1)
    return put_unit(state, again), [replace(death, restart_in=delay)]


def _end_when_idle(state: State, reported: list[Action], now: float) -> Step:
    """End the run with its last node, unless the user stopped one and may start it again."""
    nodes = [each for each in state.units if not each.unit.core and not each.unit.helper] or list(state.units)
    waits = state.effects or any(each.due is not None for each in state.planned)
    if state.phase is not RunPhase.RUNNING or waits or any(other.held or other.goes_on for other in nodes):
        return state, reported
    # As in roslaunch, which has no limit to respawning: otherwise only units that never started count.
    failed = any(other.exit == ExitStatus() or other.gave_up for other in nodes)
    state, actions = begin_end(state, "every node has ended", int(failed), now)
    return state, reported + actions


def begin_state(
    units: Iterable[Unit],
    *,
    own_master: bool,
    limits: TimeLimits | None = None,
    shared: bool = False,
    planned: tuple[Planned, ...] = (),
) -> State:
    """Return the initial state. Units start in this order, core units first and terminal units last."""
    ordered = sorted(units, key=lambda unit: (not unit.core, unit.terminal))
    places = {unit.name: place for place, unit in enumerate(ordered)}
    return State(
        tuple(UnitState(unit) for unit in ordered),
        own_master,
        limits or TimeLimits(),
        shared=shared,
        planned=planned,
        places=places,
    )


def step(state: State, event: Event, now: float) -> tuple[State, tuple[Action, ...]]:
    """Compute the next state and the actions for an event. `now` is any monotonic clock, in s."""
    following, actions = _handle(note_effects(state, event, now), event, now)
    if effects := following.effects:
        following = replace(following, effects=())
        for effect in effects:
            following, more = _apply_effect(following, effect, now)
            actions = [*actions, *more]
        following, more = _end_when_idle(following, [], now)
        actions = [*actions, *more]
    return following, tuple(actions)


def _apply_effect(state: State, effect: Effect, now: float) -> Step:
    if isinstance(effect, PrintPlanned):
        return state, [ReportPlanned(effect.text)]
    if not is_before(state, RunPhase.STOPPING_NODES):
        return state, []
    if isinstance(effect, EndPlanned):
        return begin_end(state, effect.reason, 0, now)
    each = state.find(effect.name)
    return (state, []) if each is None or each.held else start_units(state, [each], now)


def next_deadline(state: State) -> float | None:
    """Return the latest time at which `Tick` is due; None if only events matter."""
    times = []
    if state.phase is RunPhase.RUNNING and not state.reviving:
        times = [each.due for each in state.units if each.due is not None]
        times += [each.due for each in state.planned if each.due is not None]
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
            return start_units(running, (each for each in running.units if each.unit.is_first), now)
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
