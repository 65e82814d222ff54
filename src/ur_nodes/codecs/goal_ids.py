"""Names and states of goals."""

from __future__ import annotations

from typing import Any

from ur_nodes.codecs.codec import Codec
from ur_nodes.codecs.dialect import ROS_2, stamp_of, time_of
from ur_nodes.ports.actions import GoalId

if ROS_2:
    from action_msgs.msg import GoalInfo as IdMessage
else:
    from actionlib_msgs.msg import GoalID as IdMessage


def _fill_id(message: Any, value: GoalId) -> None:
    message.id, message.stamp = value.id, time_of(value.stamp)


CODECS = {GoalId: Codec(IdMessage, _fill_id, lambda message: GoalId(message.id, stamp_of(message.stamp)))}
