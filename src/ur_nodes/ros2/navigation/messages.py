"""Nav2's actions, if its messages are installed. Fields that a release lacks are neither read nor written."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from ur_nodes.codecs.dialect import duration_of
from ur_nodes.codecs.poses import fill_stamped, stamped_of
from ur_nodes.ports.values import StampedPose

if TYPE_CHECKING:
    from nav2_msgs.action import NavigateToPose
    from unique_identifier_msgs.msg import UUID

UNKNOWN_ERROR = 9000
_MOST_POSES = 1000
_REASONS = {
    102: "a transform is missing",
    104: "no velocity command was found for too long",
    105: "the robot makes no progress",
    106: "every velocity command would collide",
    202: "a transform is missing",
    203: "the robot is outside of the map",
    204: "the goal is outside of the map",
    205: "the robot is inside of an obstacle",
    206: "the goal is inside of an obstacle",
    207: "planning took too long",
    208: "there is no path to the goal",
    9001: "its behavior tree cannot be loaded",
    9002: "a transform is missing",
    9003: "it took too long",
}
"""Errors of FollowPath (1..), ComputePathToPose (2..) and NavigateToPose (9...), as nav2_msgs numbers them."""


def find_action(name: str) -> type[NavigateToPose] | None:
    """Find one of Nav2's actions; None if its messages are not installed."""
    try:
        found: type[NavigateToPose] = getattr(import_module("nav2_msgs.action"), name)
    except (ImportError, AttributeError):
        return None
    return found


def key_message(key: bytes) -> UUID:
    """The name of a goal, of 16 bytes."""
    from unique_identifier_msgs.msg import UUID

    return UUID(uuid=list(key))  # type: ignore[arg-type]  # ROS 2 wants numbers of what it gives as bytes


def targets_of(goal: NavigateToPose.Goal) -> tuple[StampedPose, ...]:
    """Return the poses of a goal, in order. Raises ValueError if there are none, or too many."""
    if hasattr(goal, "pose"):
        return (stamped_of(goal.pose),)
    poses = goal.poses if isinstance(goal.poses, list) else goal.poses.goals
    if not 1 <= len(poses) <= _MOST_POSES:
        raise ValueError(f"goal with {len(poses)} poses, expected 1 to {_MOST_POSES}")
    return tuple(map(stamped_of, poses))


def fill_target(goal: NavigateToPose.Goal, target: StampedPose) -> None:
    """Write a goal of one pose."""
    fill_stamped(goal.pose, target)


def fill_feedback(
    message: NavigateToPose.Feedback, pose: StampedPose, seconds: float, distance: float, poses: int
) -> None:
    """Write the robot's pose, its driving time (s), the remaining distance (m), and the number of remaining poses."""
    fill_stamped(message.current_pose, pose)
    message.navigation_time = duration_of(max(0.0, seconds))
    message.distance_remaining = distance
    if hasattr(message, "number_of_poses_remaining"):
        message.number_of_poses_remaining = poses


def fill_result(message: NavigateToPose.Result, problem: str) -> None:
    """Write the reason why a goal was given up; '' for one that was reached or cancelled."""
    if problem and hasattr(message, "error_code"):
        message.error_code = UNKNOWN_ERROR
    if problem and hasattr(message, "error_msg"):
        message.error_msg = problem


def reason_of(result: NavigateToPose.Result) -> str:
    """Return the reason of a result; '' for none."""
    code, text = int(getattr(result, "error_code", 0)), str(getattr(result, "error_msg", ""))
    known = _REASONS.get(code, f"error {code} of Nav2" if code not in (0, UNKNOWN_ERROR) else "")
    return ": ".join(each for each in (known, text) if each)
