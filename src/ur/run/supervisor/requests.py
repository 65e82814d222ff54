"""Requests of the user about one unit of a run: start, stop, kill, restart. Pure."""

from __future__ import annotations

from dataclasses import replace

from ur.run.supervisor.actions import (
    SIGNALS,
    Action,
    ReportPressure,
    ReportRequest,
    SignalUnit,
    Step,
    is_before,
    put_unit,
    signal_patience,
    start_units,
)
from ur.run.supervisor.events import KillNode, NodeRequest, RestartNode, StartNode
from ur.run.supervisor.state import RunPhase, State, StopRequest, UnitState, UnitStatus


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
