"""Reactions of a run when its master, the robot, or the link to it is lost or returns. Pure."""

from __future__ import annotations

from dataclasses import replace

from ur.run.supervisor.actions import ReportLink, ReportMaster, ReportRevival, SetParameters, StartShare
from ur.run.supervisor.changes import Step
from ur.run.supervisor.events import (
    Event,
    LinkLost,
    LinkRestored,
    MasterGone,
    MasterLost,
    MasterReplaced,
    MasterReturned,
    ShareFailed,
    ShareStarted,
)
from ur.run.supervisor.model import State
from ur.run.supervisor.shutdown import begin_end


def follow_master(state: State, event: Event, now: float) -> Step:
    """React to an event of the master or of the link. A lost link alone changes nothing: nodes go on.

    Another master knows neither parameters nor nodes. A robot that has a share of the run starts that again first.
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
        case MasterReplaced() | MasterGone() if state.shared:
            if state.reviving:
                return state, []  # the master that the robot's share starts is seen here, too
            return replace(state, reviving=True), [ReportRevival(), StartShare()]
        case MasterReplaced():
            return replace(state, reviving=True, stale=False), [ReportRevival(), SetParameters()]
        case MasterGone(seconds) if seconds >= state.limits.robot:
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
