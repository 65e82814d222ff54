"""The lifecycle of one unit: the steps after its process has started, and after it has ended. Pure."""

from __future__ import annotations

from dataclasses import replace
from signal import SIGINT

from ur.run.supervisor.actions import SIGNALS, Action, ReportDeath, SignalUnit, Step, is_before, put_unit
from ur.run.supervisor.requests import fulfil_request
from ur.run.supervisor.shutdown import advance_end, begin_end
from ur.run.supervisor.state import ExitStatus, RunPhase, State, TimeLimits, UnitState, UnitStatus


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
    if each.unit.respawn and not evicted_by:
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
    if _is_storm(quick, death.status, state.limits):
        each = replace(each, gave_up=True, reason=each.reason or f"died {quick} times in a row")
        return _end_when_idle(put_unit(state, each), [replace(death, deaths=quick)], now)
    delay = max(each.unit.respawn_delay, _backoff(quick, state.limits))
    again = replace(each, status=UnitStatus.WAITING, due=now + delay, restarts=each.restarts + 1)
    return put_unit(state, again), [replace(death, restart_in=delay)]


def _end_when_idle(state: State, reported: list[Action], now: float) -> Step:
    """End the run with its last node, unless the user stopped one and may start it again."""
    nodes = [other for other in state.units if not other.unit.core]
    if state.phase is not RunPhase.RUNNING or any(
        other.status is not UnitStatus.ENDED or other.held for other in nodes
    ):
        return state, reported
    # As in roslaunch, which has no limit to respawning: otherwise only units that never started count.
    failed = any(other.exit == ExitStatus() or other.gave_up for other in nodes)
    state, actions = begin_end(state, "every node has ended", int(failed), now)
    return state, reported + actions


def _is_storm(quick_deaths: int, status: ExitStatus, limits: TimeLimits) -> bool:
    if not limits.quick_deaths:
        return False
    return quick_deaths >= (min(limits.bad_inputs, limits.quick_deaths) if status.code == 2 else limits.quick_deaths)


def _backoff(quick_deaths: int, limits: TimeLimits) -> float:
    # The first restart is as prompt as in roslaunch; only a unit that keeps dying is delayed.
    return 0.0 if quick_deaths < 2 else min(limits.longest_backoff, 0.25 * 2.0 ** min(quick_deaths - 2, 16))
