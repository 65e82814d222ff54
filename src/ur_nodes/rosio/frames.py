"""The transform tree of the topics /tf and /tf_static."""

from __future__ import annotations

from collections.abc import Callable

import rospy
from tf2_msgs.msg import TFMessage

from ur_nodes.codecs.geometry import pose3_of_transform
from ur_nodes.geometry.pose import Pose3
from ur_nodes.geometry.transform_tree import TransformError, TransformTree


class Frames(TransformTree):
    """A transform tree that listens. Less than tf2_ros.TransformListener: no service, no blocking, no action client.

    `on_change` is called after every message, in rospy's thread; `ignored` are child frames to skip, such as the one
    that the node itself publishes.
    """

    def __init__(
        self, on_change: Callable[[], None] | None = None, ignored: frozenset[str] = frozenset(), keep: float = 10.0
    ) -> None:
        super().__init__(keep)
        self._on_change = on_change
        self._ignored = ignored
        rospy.Subscriber("/tf_static", TFMessage, self._take, callback_args=True, queue_size=100)
        rospy.Subscriber("/tf", TFMessage, self._take, callback_args=False, queue_size=200, tcp_nodelay=True)

    def find(self, target: str, source: str, stamp: rospy.Time) -> Pose3 | None:
        """Return the pose of `source` in `target` at a stamp (zero: the newest), None while it is not known."""
        try:
            return self.lookup(target, source, None if stamp.is_zero() else stamp.to_sec())
        except TransformError:
            return None

    def _take(self, message: TFMessage, fixed: bool) -> None:
        used = False
        for item in message.transforms:
            if item.child_frame_id.lstrip("/") not in self._ignored:
                stamp, pose = item.header.stamp.to_sec(), pose3_of_transform(item.transform)
                self.add(item.header.frame_id, item.child_frame_id, stamp, pose, fixed=fixed)
                used = True
        if used and self._on_change:
            self._on_change()
