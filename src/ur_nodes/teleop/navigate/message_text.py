"""Messages about goals and requests, one line each."""

import math
from collections.abc import Mapping
from dataclasses import replace

from ur_nodes.client.driver_text import DriverRequest
from ur_nodes.client.snapshot import LastGoalState, RobotSnapshot, format_pose
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.navigate.status_text import silence_line

REQUESTED: dict[DriverRequest, str] = {
    "take": "requested to drive from this computer",
    "ask": "asked the driving client to hand over",
    "grant": "handing over to the client that asked",
}
"""The message when the lease was requested."""


def announce_goal(snapshot: RobotSnapshot) -> tuple[str, str]:
    """Return the message about the state of the goal, and its style. The goal has a place."""
    report = snapshot.goal
    assert report.pose is not None
    where = format_pose(report.pose, any_heading=report.any_heading)
    if report.state is LastGoalState.REACHED and snapshot.pose is not None:
        off = math.hypot(report.pose.x - snapshot.pose.x, report.pose.y - snapshot.pose.y)
        return f"reached {where}, {off:.2f} m off", "green"
    if report.state is LastGoalState.FAILED:
        return f"{where}: failed: {report.text}", "bold red"
    if report.state is LastGoalState.STOPPED:
        why = f": {report.text}" if report.text not in ("", "cancelled") else ""
        return f"stopped on the way to {where}{why}", "yellow"
    if report.state in (LastGoalState.HELD, LastGoalState.ASKING):
        return f"held on the way to {where}", "yellow"
    if report.state is LastGoalState.UNKNOWN:
        return f"state of the goal {where} unknown", "yellow"
    return f"{'sent' if report.state is LastGoalState.WAITING else 'driving'} to {where}", ""


def describe_stop(snapshot: RobotSnapshot) -> str:
    """Return the message after the goal was cancelled by a command."""
    if silent := silence_line(snapshot):
        return f"stop requested, but there is {silent}"
    return "no goal to stop" if snapshot.goal.over else "stopped"


def visible_state(snapshot: RobotSnapshot, places: Mapping[str, Pose2], size: object) -> tuple[object, ...]:
    """Return everything that the screen depends on, rounded to visible differences."""
    pose = snapshot.pose
    return (
        id(snapshot.grid),
        (round(pose.x, 3), round(pose.y, 3), round(pose.yaw, 3)) if pose else None,
        snapshot.scan.round(2).tobytes() if snapshot.scan is not None and snapshot.goal.over else id(snapshot.scan),
        id(snapshot.path),
        snapshot.goal,
        round(snapshot.speed, 2),
        round(snapshot.spread, 2) if snapshot.spread is not None else None,
        snapshot.missing,
        snapshot.mux,
        snapshot.patrol,
        replace(snapshot.lease, link_age=0.0),
        (snapshot.silence.who, round(snapshot.silence.seconds, 1)) if snapshot.silence else None,
        tuple(places.items()),
        size,
    )
