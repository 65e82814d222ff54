"""Lines about the goals of a batch: results, reasons to give up, changes while driving. Pure."""

import math
from dataclasses import dataclass

from ur_nodes.client.snapshot import GoalReport, LastGoalState, RobotSnapshot
from ur_nodes.geometry.pose import wrap_angle
from ur_nodes.teleop.navigate.status_text import silence_line


@dataclass(frozen=True, slots=True)
class BatchTimeouts:
    """Timeouts in s: until map, pose and navigation are available, and for one goal."""

    start: float = 30.0
    goal: float = 600.0


def result_line(text: str, report: GoalReport, snapshot: RobotSnapshot, seconds: float) -> str:
    """Describe the end of a goal: `g 2 3 90: reached, 0.04 m and 1.2 degrees off, 12.3 s`."""
    goal, pose = report.pose, snapshot.pose
    if report.state is LastGoalState.REACHED and goal is not None and pose is not None:
        off = math.hypot(goal.x - pose.x, goal.y - pose.y)
        turned = math.degrees(abs(wrap_angle(goal.yaw - pose.yaw)))
        angle = "" if report.any_heading else f" and {turned:.1f} degrees"
        return f"{text}: reached, {off:.2f} m{angle} off, {seconds:.1f} s"
    why = f": {report.text}" if report.text else ""
    return f"{text}: {report.state.value} after {seconds:.1f} s{why}"


def reason_to_give_up(snapshot: RobotSnapshot, seconds: float, limits: BatchTimeouts, *, attended: bool) -> str:
    """Return the reason to stop waiting for a goal after `seconds`; empty while there is none.

    `attended`: a user is there to answer whether a goal that was held goes on.
    """
    if snapshot.goal.state is LastGoalState.ASKING and not attended:
        return f"stopped after {seconds:.1f} s: held, and a pipe cannot answer whether it goes on"
    silent = silence_line(snapshot)
    if seconds > limits.goal:
        limit = f"not reached after {seconds:.0f} s, the limit (parameter ~goal_timeout)"
        return f"unknown: {limit}; {silent}" if silent else f"failed: {limit}; stopped"
    if snapshot.silence is not None and snapshot.silence.seconds > limits.start:
        return f"unknown after {seconds:.1f} s: {silent}"
    return ""


def goal_change(snapshot: RobotSnapshot, noted: LastGoalState | None) -> LastGoalState | None:
    """Return the state of a goal that is worth a note; None while it is driven. `noted` is the one before."""
    state = snapshot.goal.state
    if state in (LastGoalState.HELD, LastGoalState.ASKING, LastGoalState.UNKNOWN):
        return state
    return None if state is LastGoalState.DRIVING else noted


def describe_change(snapshot: RobotSnapshot, change: LastGoalState | None) -> str:
    """Return a clause about a goal that is held or unknown, or that continues (None)."""
    if change is LastGoalState.HELD:
        return snapshot.goal.text
    if change is LastGoalState.ASKING:
        return "held: the robot waits for you; c continues, x cancels"
    if change is LastGoalState.UNKNOWN:
        return f"{silence_line(snapshot)}; the goal is unknown until it answers"
    return "driving"
