"""What is read from Nav2's messages, and written to them; releases differ in their fields."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.values import StampedPose
from ur_nodes.ros2.navigation.messages import (
    UNKNOWN_ERROR,
    fill_feedback,
    fill_result,
    fill_target,
    find_action,
    reason_of,
    targets_of,
)

pytestmark = pytest.mark.ros
THERE = StampedPose(2_000_000_000, "map", Pose2(1.0, -2.0, 0.5))


def goal_of(*poses: PoseStamped) -> Any:
    return SimpleNamespace(poses=list(poses))


def test_action_that_is_not_installed_is_none() -> None:
    assert find_action("NoSuchAction") is None


def test_target_that_is_written_is_read_again() -> None:
    goal: Any = SimpleNamespace(pose=PoseStamped())
    fill_target(goal, THERE)
    [target] = targets_of(goal)
    assert target.frame == "map"
    assert target.pose == pytest.approx(THERE.pose)


def test_poses_are_read_in_their_order_from_either_kind_of_list() -> None:
    first, second = PoseStamped(), PoseStamped()
    fill_target(SimpleNamespace(pose=first), THERE)  # type: ignore[arg-type]
    second.pose.orientation.w = 1.0
    newer: Any = SimpleNamespace(poses=SimpleNamespace(goals=[first, second]))
    for goal in (goal_of(first, second), newer):
        assert [each.pose.x for each in targets_of(goal)] == pytest.approx([1.0, 0.0])


@pytest.mark.parametrize("count", [0, 1001])
def test_goal_without_poses_or_with_too_many_is_refused(count: int) -> None:
    with pytest.raises(ValueError, match=f"goal with {count} poses, expected 1 to 1000"):
        targets_of(goal_of(*[PoseStamped()] * count))


def test_feedback_has_what_the_release_knows() -> None:
    older: Any = SimpleNamespace(current_pose=PoseStamped())
    newer: Any = SimpleNamespace(current_pose=PoseStamped(), number_of_poses_remaining=0)
    for feedback in (older, newer):
        fill_feedback(feedback, THERE, -1.0, 2.5, 3)
        assert feedback.distance_remaining == 2.5
        assert feedback.current_pose.pose.position.x == 1.0
    assert newer.number_of_poses_remaining == 3
    assert not hasattr(older, "number_of_poses_remaining")


def test_reason_is_written_and_read_where_the_release_has_fields_for_it() -> None:
    older: Any = SimpleNamespace()
    newer: Any = SimpleNamespace(error_code=0, error_msg="")
    for result in (older, newer):
        fill_result(result, "emergency stop")
    assert (newer.error_code, reason_of(newer), reason_of(older)) == (UNKNOWN_ERROR, "emergency stop", "")
    fill_result(reached := SimpleNamespace(error_code=0, error_msg=""), "")  # type: ignore[arg-type]
    assert reason_of(reached) == ""  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("code", "text", "reason"),
    [
        (208, "", "there is no path to the goal"),
        (299, "x", "error 299 of Nav2: x"),
        (105, "stuck", "the robot makes no progress: stuck"),
    ],
)
def test_numbers_of_nav2_have_words(code: int, text: str, reason: str) -> None:
    assert reason_of(SimpleNamespace(error_code=code, error_msg=text)) == reason  # type: ignore[arg-type]
