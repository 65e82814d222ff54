"""Messages of ROS 1 in recordings, read as the values that a subscription gets of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeVar

import genpy
from actionlib_msgs.msg import GoalStatusArray
from move_base_msgs.msg import MoveBaseActionFeedback, MoveBaseActionGoal, MoveBaseActionResult

from ur_nodes.codecs import KindCodec, find_codec
from ur_nodes.codecs.frames import transforms_of
from ur_nodes.codecs.poses import stamped_of
from ur_nodes.ports.actions import Goal, GoalState, GoalStates
from ur_nodes.ports.values import StampedPose
from ur_nodes.ros1.goals import state_of

_Message = TypeVar("_Message", bound=genpy.Message)


@dataclass(frozen=True, slots=True)
class StoredReader:
    """Reads the messages of a recorded topic and type; `read` raises ValueError and UserError."""

    topic: str
    type_name: str
    read: Callable[[bytes], object]


def _goal_of(message: MoveBaseActionGoal) -> Goal:
    return Goal(str(message.goal_id.id), stamped_of(message.goal.target_pose))


def find_reader(topic: str, kind: type) -> StoredReader | None:
    """Find what a subscription of a kind reads; None: ROS 1 has no message for it."""
    action, _, part = topic.rpartition("/")
    if make := _ACTION.get((kind, part)):
        return make(action)
    try:
        codec: KindCodec[object] = find_codec(kind)
    except KeyError:
        return None
    if topic == "/tf_static":
        return _make(topic, codec.message_class, lambda message: transforms_of(message, fixed=True))
    return _make(topic, codec.message_class, codec.value_of)


def _make(topic: str, message_class: type[_Message], value_of: Callable[[_Message], object]) -> StoredReader:
    def read(data: bytes) -> object:
        try:
            return value_of(message_class().deserialize(data))
        except genpy.DeserializationError as problem:
            raise ValueError(str(problem)) from None

    return StoredReader(topic, str(message_class._type), read)


_ACTION: Mapping[tuple[type, str], Callable[[str], StoredReader]] = {
    (Goal, "goal"): lambda action: _make(f"{action}/goal", MoveBaseActionGoal, _goal_of),
    (GoalStates, "status"): lambda action: _make(
        f"{action}/status", GoalStatusArray, lambda message: GoalStates(tuple(map(state_of, message.status_list)))
    ),
    (GoalState, "state"): lambda action: _make(
        f"{action}/result", MoveBaseActionResult, lambda message: state_of(message.status)
    ),
    (StampedPose, "feedback"): lambda action: _make(
        f"{action}/feedback", MoveBaseActionFeedback, lambda message: stamped_of(message.feedback.base_position)
    ),
}
"""Readers of topics of an action by what nodes on a bus exchange; ROS 1 has other names for some."""
