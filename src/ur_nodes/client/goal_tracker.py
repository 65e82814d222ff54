"""Tracking of a goal from the states that navigation sends, as a step function."""

from dataclasses import dataclass, field, replace
from typing import Final, Literal

from ur.source.foreign.json_values import BadJsonError, ForeignValue, read_json
from ur.source.printable import one_line
from ur_nodes.client.snapshot import GoalReport, LastGoalState
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS
from ur_nodes.navigation.goals.goal_claim import has_any_heading
from ur_nodes.ports import actions

_LONGEST_HOLD: Final = 4096
LONGEST_TEXT: Final = 500
"""Characters of a text of a node that are shown."""

_STATES: Final = {
    "pending": LastGoalState.WAITING,
    "active": LastGoalState.DRIVING,
    "succeeded": LastGoalState.REACHED,
    "cancelled": LastGoalState.STOPPED,
    "aborted": LastGoalState.FAILED,
}
ANSWER_LIMIT = 5.0
"""Seconds of status lists without a goal after which move_base does not have it. It sends five lists a second."""

SILENCE = 1.0
"""Seconds without a status list after which the state of a goal is unknown."""

LATE = 1.0
"""Seconds after the end of a goal in which word of a goal to the same place is about that one."""

_MOST_OVERDUE: Final = 7


@dataclass(frozen=True, slots=True)
class GoalTracker:
    """The tracked goal. `goal_id` is '' while it is another client's and its id is unknown.

    `known`: move_base has listed it as active, or sent its result. `received_at` is when it was sent or mentioned last,
    `listed_at` when the last status list arrived, `absent_since` since when lists arrive without the goal. `replaced`
    is the id of the goal before, and `overdue` are the places of goals of this client that were replaced before
    move_base reported them: messages about both may arrive after this goal was sent or reported.
    """

    report: GoalReport = field(default_factory=GoalReport)
    goal_id: str = ""
    received_at: float = 0.0
    known: bool = False
    listed_at: float = 0.0
    absent_since: float | None = None
    hold: str = ""
    replaced: str = ""
    overdue: tuple[Pose2, ...] = ()


def track_sent(tracker: GoalTracker, goal_id: str, pose: Pose2, now: float, number: int = 0) -> GoalTracker:
    """Start to track a goal of this client, with the sender's number or (0) the next one."""
    any_heading = has_any_heading(goal_id)
    report = GoalReport(number or tracker.report.number + 1, pose, LastGoalState.WAITING, any_heading=any_heading)
    open_place = None if tracker.report.over or not tracker.goal_id else tracker.report.pose
    overdue = (*tracker.overdue[-_MOST_OVERDUE:], open_place) if open_place is not None else ()
    return GoalTracker(report, goal_id, now, listed_at=now, hold=tracker.hold, overdue=overdue)


def track_current(tracker: GoalTracker, pose: Pose2, now: float) -> GoalTracker:
    """Take the goal that move_base drives to; one that is not ours is another client's.

    move_base keeps its last goal on the topic, so that one is reported only once it is known to be active, or ends.
    """
    ours = tracker.report.pose
    same = ours is not None and _is_same(ours, pose)
    # Results come by another connection and may overtake the message about the goal that they end.
    if same and (not tracker.report.over or now - tracker.received_at < LATE):
        return replace(tracker, overdue=())
    if not tracker.report.over and any(_is_same(pose, each) for each in tracker.overdue):
        return tracker
    report = GoalReport(tracker.report.number + 1, pose, LastGoalState.DRIVING)
    replaced = tracker.goal_id or tracker.replaced
    return GoalTracker(report, "", now, listed_at=now, hold=tracker.hold, replaced=replaced)


def track_status(tracker: GoalTracker, statuses: tuple[actions.GoalState, ...], now: float) -> GoalTracker:
    """Take a status list. A goal that is in no list for `ANSWER_LIMIT` has failed; missing lists prove nothing."""
    if tracker.report.over:
        return tracker
    for status in statuses:
        if tracker.goal_id == status.id or (not tracker.goal_id and status.open and status.id != tracker.replaced):
            found = replace(tracker, goal_id=status.id, listed_at=now, absent_since=None)
            return _apply(found, status, now)
    if not tracker.goal_id and now - tracker.received_at > LATE:
        # It ended before this client started.
        return replace(tracker, listed_at=now, report=GoalReport(tracker.report.number))
    silent = now - tracker.listed_at > SILENCE
    since = now if silent or tracker.absent_since is None else tracker.absent_since
    tracker = replace(tracker, listed_at=now, absent_since=since)
    if now - since <= ANSWER_LIMIT:
        return tracker
    reason = (
        "move_base does not know the goal any more; was it restarted?"
        if tracker.known
        else "the goal did not reach move_base; send it again"
    )
    return replace(tracker, report=replace(tracker.report, state=LastGoalState.FAILED, text=reason))


def track_result(tracker: GoalTracker, status: actions.GoalState, now: float) -> GoalTracker:
    """Note the result of a goal."""
    if tracker.report.over or (tracker.goal_id and tracker.goal_id != status.id) or status.id == tracker.replaced:
        return tracker
    return _apply(tracker, status, now)


def is_unconfirmed(tracker: GoalTracker, now: float) -> bool:
    """Return whether to send a goal of this client again, after a status list: it was in none so far.

    A message can be lost while nodes find each other: a recorder may receive goals before navigation does. The server
    takes a goal once. A later one would be refused, or begin after its sender has given up.
    """
    sent = tracker.goal_id and not tracker.known and not tracker.report.over
    return bool(sent) and now - tracker.received_at <= REQUEST_FRESHNESS


def track_hold(tracker: GoalTracker, hold: str) -> GoalTracker:
    """Take the id of the goal that move_base holds; '' for none."""
    return replace(tracker, hold=hold)


def report_at(tracker: GoalTracker, now: float) -> GoalReport:
    """Return the report at `now`: an open goal is unknown while move_base is silent."""
    report = tracker.report
    if report.over:
        return report
    if now - tracker.listed_at > SILENCE:
        return replace(report, state=LastGoalState.UNKNOWN, text="")
    if not (tracker.goal_id or tracker.known):
        return GoalReport(report.number)
    if report.state is LastGoalState.DRIVING and tracker.hold and tracker.hold == tracker.goal_id:
        return replace(report, state=LastGoalState.HELD)
    return replace(report, text="")


class _WireHold(ForeignValue, frozen=True, forbid_unknown_fields=False):
    goal: str
    state: Literal["", "held"]


def read_hold(text: str) -> str | None:
    """Return the id of the goal that a message of move_base's topic `hold` names; None when it is malformed."""
    try:
        found = read_json(text, _WireHold, _LONGEST_HOLD)
    except BadJsonError:
        return None
    return found.goal if found.state else ""


def _is_same(a: Pose2, b: Pose2) -> bool:
    return abs(a.x - b.x) + abs(a.y - b.y) < 1e-3


def _apply(tracker: GoalTracker, status: actions.GoalState, now: float) -> GoalTracker:
    state = _STATES[status.state]
    text = "" if state is LastGoalState.REACHED else one_line(status.text[:LONGEST_TEXT])
    if state is LastGoalState.FAILED and not text:
        text = "move_base gave no reason"
    any_heading = has_any_heading(tracker.goal_id)
    report = replace(tracker.report, state=state, text=text, any_heading=any_heading, recoveries=status.recoveries)
    return replace(tracker, received_at=now, known=True, report=report)
