"""What became of a goal: the client's side of actionlib, as a step function.

Status numbers and their meaning: actionlib_msgs/GoalStatus.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Final

from ur_nodes.teleop.navigator import GoalReport, GoalState, Place

_RUNNING: Final = {0: GoalState.WAITING, 1: GoalState.DRIVING, 6: GoalState.DRIVING, 7: GoalState.WAITING}
_OVER: Final = {
    2: GoalState.STOPPED,
    3: GoalState.REACHED,
    4: GoalState.FAILED,
    5: GoalState.FAILED,
    8: GoalState.STOPPED,
    9: GoalState.FAILED,
}
ANSWER_LIMIT = 5.0
"""Seconds without a word about a running goal after which it counts as lost. move_base reports five times a second."""

LATE = 1.0
"""Seconds after the end of a goal in which word of a goal to the same place is about that one."""


@dataclass(frozen=True, slots=True)
class Status:
    """One entry of a status list."""

    goal_id: str
    status: int
    text: str


@dataclass(frozen=True, slots=True)
class Tracker:
    """The goal that is followed. `goal_id` is '' while it is somebody else's and not known by id yet."""

    report: GoalReport = field(default_factory=GoalReport)
    goal_id: str = ""
    heard_at: float = 0.0


def track_sent(tracker: Tracker, goal_id: str, place: Place, now: float) -> Tracker:
    """A goal of ours leaves."""
    report = GoalReport(tracker.report.number + 1, place, GoalState.WAITING)
    return Tracker(report, goal_id, now)


def track_current(tracker: Tracker, place: Place, now: float) -> Tracker:
    """move_base says which goal it drives to; another one than ours was sent by somebody else."""
    ours = tracker.report.place
    same = ours is not None and abs(ours.x - place.x) + abs(ours.y - place.y) < 1e-3
    # Results come by another connection and may overtake the word about the goal that they end.
    if same and (not tracker.report.over or now - tracker.heard_at < LATE):
        return tracker
    return Tracker(GoalReport(tracker.report.number + 1, place, GoalState.DRIVING), "", now)


def track_status(tracker: Tracker, statuses: tuple[Status, ...], now: float) -> Tracker:
    """A status list came. A followed goal that is in no list for `ANSWER_LIMIT` is lost."""
    if tracker.report.over:
        return tracker
    for status in statuses:
        if tracker.goal_id == status.goal_id or (not tracker.goal_id and status.status in _RUNNING):
            return _apply(replace(tracker, goal_id=status.goal_id), status, now)
    return track_time(tracker, now, "move_base does not know the goal any more; was it restarted?")


def track_result(tracker: Tracker, status: Status, now: float) -> Tracker:
    """A result came."""
    if tracker.report.over or (tracker.goal_id and tracker.goal_id != status.goal_id):
        return tracker
    return _apply(tracker, status, now)


def track_time(tracker: Tracker, now: float, reason: str = "move_base does not answer; is it running?") -> Tracker:
    """Time passes without a word."""
    if tracker.report.over or now - tracker.heard_at <= ANSWER_LIMIT:
        return tracker
    return replace(tracker, report=replace(tracker.report, state=GoalState.FAILED, text=reason))


def _apply(tracker: Tracker, status: Status, now: float) -> Tracker:
    state = _OVER.get(status.status) or _RUNNING.get(status.status, tracker.report.state)
    text = status.text.strip() if state in (GoalState.FAILED, GoalState.STOPPED) else ""
    if state is GoalState.FAILED and not text:
        text = "move_base gave no reason"
    return replace(tracker, heard_at=now, report=replace(tracker.report, state=state, text=text))
