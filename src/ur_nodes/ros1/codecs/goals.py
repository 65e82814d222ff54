"""Names of goals."""

from __future__ import annotations

from typing import Any

from actionlib_msgs.msg import GoalID

from ur_nodes.ports.actions import GoalId
from ur_nodes.ros1.codecs.codec import Codec, stamp_of, time_of


def _fill_id(message: Any, value: GoalId) -> None:
    message.id, message.stamp = value.id, time_of(value.stamp)


CODECS = {GoalId: Codec(GoalID, _fill_id, lambda message: GoalId(message.id, stamp_of(message.stamp)))}
