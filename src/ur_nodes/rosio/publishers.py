"""Publishers that start sending at once, and the one style in which nodes publish /tf."""

from __future__ import annotations

import threading
import warnings
from typing import Any

import rospy
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from ur_nodes.codecs.geometry import fill_transform
from ur_nodes.geometry.pose import Pose2, Pose3

Edge = tuple[str, str, Pose2 | Pose3]
"""An edge of the transform tree: the parent frame, the child frame, and the child's pose in the parent."""


def make_publisher(topic: str, kind: Any, queue: int | None) -> rospy.Publisher:
    """A publisher that drops the oldest of more than `queue` unsent messages; None: it waits until each is sent."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)  # rospy takes a missing queue size for a mistake
        return rospy.Publisher(topic, kind, queue_size=queue, tcp_nodelay=True)


class TransformSender:
    """The publisher of /tf of a node, for any thread. Messages are made once for each edge and filled in again."""

    def __init__(self, queue: int | None = 100) -> None:
        """`queue` as in `make_publisher`."""
        self._publisher = make_publisher("/tf", TFMessage, queue)
        self._lock = threading.Lock()  # guards the messages
        self._message = TFMessage()
        self._transforms: dict[tuple[str, str], TransformStamped] = {}

    def send(self, stamp: rospy.Time, *edges: Edge) -> None:
        """Publish edges as of a stamp, in one message."""
        with self._lock:
            self._message.transforms = [self._fill(stamp, *edge) for edge in edges]
            self._publisher.publish(self._message)

    def _fill(self, stamp: rospy.Time, parent: str, child: str, pose: Pose2 | Pose3) -> TransformStamped:
        message = self._transforms.get((parent, child))
        if message is None:
            message = self._transforms[parent, child] = TransformStamped(child_frame_id=child)
            message.header.frame_id = parent
        message.header.stamp = stamp
        fill_transform(message.transform, pose)
        return message
