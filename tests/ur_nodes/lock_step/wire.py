"""A bus whose values are messages of ROS 1 on their way, kept in the black box's memory."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from actionlib_msgs.msg import GoalStatus, GoalStatusArray
from move_base_msgs.msg import MoveBaseActionFeedback, MoveBaseActionGoal, MoveBaseActionResult
from tests.ur_nodes.lock_step.stored import find_reader

from ur_nodes.black_box.history import HistoryTopic, MessageHistory, Ring, read_history
from ur_nodes.black_box.recording_file import write_recording
from ur_nodes.codecs import find_codec
from ur_nodes.codecs.poses import fill_stamped
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.carrier import BusPublisher
from ur_nodes.ports.actions import Goal, GoalState, GoalStates
from ur_nodes.ports.values import StampedPose

DELAY = 1_000_003
"""ns that a value is on its way, so that none arrives at the moment of a timer."""

BEGIN = HistoryTopic("/begin", "std_msgs/Empty", "")
_STATES = {
    "pending": GoalStatus.PENDING,
    "active": GoalStatus.ACTIVE,
    "succeeded": GoalStatus.SUCCEEDED,
    "aborted": GoalStatus.ABORTED,
    "cancelled": GoalStatus.PREEMPTED,
}


class WireBus(Bus):
    """A bus on which each value arrives as ROS 1 carries it. What has no message arrives as it is, unrecorded."""

    def __init__(self, delay: object = None) -> None:
        super().__init__(delay or (lambda _topic: DELAY))  # type: ignore[arg-type]
        self._time = 1_700_000_000_000_000_000
        self._begin = 0
        self._messages: list[tuple[HistoryTopic, int, bytes]] = []
        self.sent: list[tuple[str, int, str, object]] = []
        """Senders, times, topics and values of all that was sent."""

    def send(self, topic: str, offer: BusPublisher, value: object) -> None:
        """See Carrier."""
        self.sent.append((offer.sender, self.now, topic, value))
        reader = find_reader(topic, offer.kind if isinstance(offer.kind, type) else type(value))
        message = message_of(topic, value)
        if reader is None or message is None:
            super().send(topic, offer, value)
            return
        buffer = io.BytesIO()
        message.serialize(buffer)
        delay = self._delay(topic)
        if delay is not None:
            kind = HistoryTopic(reader.topic, reader.type_name, message._full_text, offer.sender, offer.latched)
            self._messages.append((kind, self.now + delay, buffer.getvalue()))
        super().send(topic, offer, reader.read(buffer.getvalue()))

    def begin_recording(self) -> None:
        """Begin now, with what is latched."""
        if not self._begin:
            self._begin = self.now

    def write(self, folder: Path, reason: str) -> Path:
        """Write the recording."""
        ring = Ring(memoryview(bytearray(40_000_000)))
        history = MessageHistory(ring)
        history.note(BEGIN, self._begin, b"")
        for kind, time, data in self._messages:
            if kind.latched or time > self._begin:
                history.note(kind, max(time, self._begin + DELAY), data)
        return write_recording(folder, tuple(read_history(ring)), [reason], 0, 10, free=10**12)


def message_of(topic: str, value: object) -> Any:
    """The message of ROS 1; None: there is none."""
    part = topic.rpartition("/")[2]
    match value:
        case Goal():
            message = MoveBaseActionGoal()
            message.goal_id.id = value.id
            fill_stamped(message.goal.target_pose, value.target)
            return message
        case GoalState():
            return None if value.open else _with_state(MoveBaseActionResult(), value)
        case GoalStates():
            return GoalStatusArray(
                status_list=[_with_state(MoveBaseActionResult(), each).status for each in value.goals]
            )
        case StampedPose() if part == "feedback":
            feedback = MoveBaseActionFeedback()
            fill_stamped(feedback.feedback.base_position, value)
            return feedback
    try:
        codec = find_codec(type(value))
    except KeyError:
        return None
    message = codec.message_class()
    codec.fill(message, value)
    return message


def _with_state(message: Any, state: GoalState) -> Any:
    message.status.goal_id.id, message.status.text = state.id, state.text
    message.status.status = _STATES[state.state]
    return message
