"""The topics /tf and /tf_static."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import rospy
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from ur_nodes.ports.values import Transform
from ur_nodes.ros1.codecs.codec import fill_header, stamp_of
from ur_nodes.rosio.geometry import pose3_of_transform


class TransformTopics:
    """Sends and receives transforms. Publishers are made with the first transform of their sort."""

    def __init__(self) -> None:
        self._moving: Any = None
        self._fixed: Any = None
        self._kept: dict[str, TransformStamped] = {}  # a latched topic keeps one message: all fixed ones go together

    def listen(self, take: Callable[[tuple[Transform, ...]], None]) -> None:
        """Have all transforms given to a function, on any thread."""
        rospy.Subscriber("/tf_static", TFMessage, lambda message: take(_read(message, fixed=True)), queue_size=100)
        rospy.Subscriber(
            "/tf", TFMessage, lambda message: take(_read(message, fixed=False)), queue_size=200, tcp_nodelay=True
        )

    def send(self, transforms: tuple[Transform, ...]) -> None:
        """Send transforms together."""
        fixed = {each.child: _message(each) for each in transforms if each.fixed}
        moving = [_message(each) for each in transforms if not each.fixed]
        try:
            if fixed:
                self._kept |= fixed
                self._fixed = self._fixed or rospy.Publisher("/tf_static", TFMessage, queue_size=100, latch=True)
                self._fixed.publish(TFMessage(list(self._kept.values())))
            if moving:
                self._moving = self._moving or rospy.Publisher("/tf", TFMessage, queue_size=100, tcp_nodelay=True)
                self._moving.publish(TFMessage(moving))
        except rospy.ROSException:  # topics are closed at the end
            if not (rospy.is_shutdown() or rospy.core.is_shutdown_requested()):
                raise


def _message(value: Transform) -> TransformStamped:
    message = TransformStamped(child_frame_id=value.child)
    fill_header(message, value.stamp, value.parent)
    place, turn = message.transform.translation, message.transform.rotation
    place.x, place.y, place.z = value.pose.x, value.pose.y, value.pose.z
    turn.x, turn.y, turn.z, turn.w = value.pose.rotation
    return message


def _read(message: Any, *, fixed: bool) -> tuple[Transform, ...]:
    return tuple(
        Transform(
            stamp_of(each.header.stamp),
            each.header.frame_id.lstrip("/"),
            each.child_frame_id.lstrip("/"),
            pose3_of_transform(each.transform),
            fixed,
        )
        for each in message.transforms
    )
