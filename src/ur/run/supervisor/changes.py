"""Small changes to the state of a run, of which the supervisor's steps consist. Pure."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from signal import SIGINT, SIGKILL, SIGTERM

from ur.run.supervisor.actions import Action, StartUnit
from ur.run.supervisor.state import RunPhase, State, TimeLimits, UnitState, UnitStatus

Step = tuple[State, list[Action]]
SIGNALS = (SIGINT, SIGTERM, SIGKILL)  # in order of increasing strength

_ORDER = list(RunPhase)


def is_before(state: State, phase: RunPhase) -> bool:
    """True while the run has not reached a phase."""
    return _ORDER.index(state.phase) < _ORDER.index(phase)


def put_unit(state: State, changed: UnitState) -> State:
    """Return the state with one unit replaced."""
    place = state.places[changed.unit.name]
    return replace(state, units=(*state.units[:place], changed, *state.units[place + 1 :]))


def start_units(state: State, chosen: Iterable[UnitState], now: float) -> Step:
    """Start the waiting ones of these units."""
    actions: list[Action] = []
    for each in chosen:
        if each.status is UnitStatus.WAITING:
            state = put_unit(
                state, replace(each, status=UnitStatus.STARTING, since=now, due=None, reason="", held=False)
            )
            actions.append(StartUnit(each.unit.name))
    return state, actions


def signal_patience(limits: TimeLimits, pressure: int) -> float:
    """Return the time to wait, in s, after the signal that follows `pressure` others."""
    return (limits.interrupt, limits.terminate, 1.0)[pressure]
