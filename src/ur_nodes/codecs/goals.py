"""Goals and their states: actionlib's names of goals on ROS 1; on ROS 2 all of `goal_topics`, as JSON in strings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, get_args, get_type_hints

from ur_nodes.codecs.codec import Codec
from ur_nodes.codecs.dialect import ROS_2, stamp_of, time_of
from ur_nodes.codecs.text import text_codec
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.actions import Goal, GoalId, GoalState, GoalStates
from ur_nodes.ports.values import PlacedPose

if TYPE_CHECKING:
    from actionlib_msgs.msg import GoalID

_STATES = get_args(get_type_hints(GoalState)["state"])


def _write_goal(goal: Goal) -> dict[str, object]:
    target, pose = goal.target, goal.target.pose
    numbers = [each if math.isfinite(each) else None for each in (pose.x, pose.y, pose.yaw)]
    return {"id": goal.id, "stamp": target.stamp, "frame": target.frame, "pose": numbers}


def _read_goal(read: dict[str, Any]) -> Goal:
    x, y, yaw = (math.nan if each is None else float(each) for each in read["pose"])
    return Goal(str(read["id"]), PlacedPose(int(read["stamp"]), str(read["frame"]), Pose2(x, y, yaw)))


def _write_state(state: GoalState) -> list[str]:
    return [state.id, state.state, state.text]


def _read_state(read: list[Any]) -> GoalState:
    id, state, text = map(str, read)
    if state not in _STATES:
        raise ValueError(f"goal in the state {state!r}, expected one of {', '.join(_STATES)}")
    return GoalState(id, state, text)  # type: ignore[arg-type]  # it is one of them


def _fill_id(message: GoalID, value: GoalId) -> None:
    message.id, message.stamp = value.id, time_of(value.stamp)


if ROS_2 and not TYPE_CHECKING:
    CODECS = {
        Goal: text_codec("goal", _write_goal, _read_goal),
        GoalId: text_codec(
            "goal", lambda value: [value.id, value.stamp], lambda read: GoalId(str(read[0]), int(read[1]))
        ),
        GoalState: text_codec("goal", _write_state, _read_state),
        GoalStates: text_codec(
            "goal",
            lambda value: [_write_state(each) for each in value.goals],
            lambda read: GoalStates(tuple(map(_read_state, read))),
        ),
    }
else:
    from actionlib_msgs.msg import GoalID

    CODECS = {GoalId: Codec(GoalID, _fill_id, lambda message: GoalId(message.id, stamp_of(message.stamp)))}
