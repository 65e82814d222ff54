"""Shutdown of a run: nodes, rosout and master, their remaining processes, registrations. Pure."""

from __future__ import annotations

from dataclasses import replace
from signal import SIGINT, SIGKILL, SIGTERM

from ur.run.supervisor.actions import (
    SIGNALS,
    Action,
    Finish,
    ReportPressure,
    ReportStop,
    SignalUnit,
    Step,
    Sweep,
    Unregister,
    put_unit,
    signal_patience,
)
from ur.run.supervisor.state import RunPhase, State, UnitStatus


def begin_end(state: State, cause: str, exit_code: int, now: float, *, failed: bool = False) -> Step:
    """End the run. `cause` is a text for the user, '' without one; `failed` means that it could not start."""
    state = replace(state, phase=RunPhase.STOPPING_NODES, exit_code=exit_code, cause=cause, pressure=0, deadline=None)
    for each in state.units:
        if each.status is UnitStatus.WAITING:
            state = put_unit(state, replace(each, status=UnitStatus.ENDED, due=None))
        else:
            state = put_unit(state, replace(each, request=None, pressure=0, deadline=None))
    reported: list[Action] = [ReportStop(cause, failed)] if cause else []
    state, actions = advance_end(state, now)
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
