"""Goals and their states: actionlib's names of goals on ROS 1; on ROS 2 all of `goal_topics`, as JSON in strings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ur_nodes.codecs.codec import Codec
from ur_nodes.codecs.dialect import ROS_2, stamp_of, time_of
from ur_nodes.codecs.text import converted_codec, text_codec
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.actions import Goal, GoalId, GoalState, GoalStates
from ur_nodes.ports.values import StampedPose

if TYPE_CHECKING:
    from actionlib_msgs.msg import GoalID


@dataclass(frozen=True, slots=True)
class _GoalText:
    """A goal; null means a number that is not finite."""

    id: str
    stamp: int
    frame: str
    pose: tuple[float | None, float | None, float | None]


def _write_goal(goal: Goal) -> _GoalText:
    pose = goal.target.pose
    return _GoalText(goal.id, goal.target.stamp, goal.target.frame, (pose.x, pose.y, pose.yaw))


def _read_goal(read: _GoalText) -> Goal:
    x, y, yaw = (math.nan if each is None else each for each in read.pose)
    return Goal(read.id, StampedPose(read.stamp, read.frame, Pose2(x, y, yaw)))


def _fill_id(message: GoalID, value: GoalId) -> None:
    message.id, message.stamp = value.id, time_of(value.stamp)


if ROS_2 and not TYPE_CHECKING:
    CODECS = {
        Goal: converted_codec("goal", _GoalText, _write_goal, _read_goal),
        GoalId: text_codec("goal", GoalId),
        GoalState: text_codec("goal", GoalState),
        GoalStates: text_codec("goals", GoalStates),
    }
else:
    from actionlib_msgs.msg import GoalID

    CODECS = {GoalId: Codec(GoalID, _fill_id, lambda message: GoalId(message.id, stamp_of(message.stamp)))}
