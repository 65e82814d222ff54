"""The tf tree as a node sees it, without waiting: transforms at a stamp, or None while they are not there yet."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import rospy
import tf2_ros
from tf2_msgs.msg import TFMessage

JUMP = 1.0  # s backwards: time itself was reset, not a late message


class Frames:
    """Listens to tf and tf_static. Less than tf2_ros.TransformListener: no service, no blocking, no action client.

    `on_change` is called after every message, in rospy's thread; `ignored` are child frames to skip, such as the one
    that the node itself publishes. What is known is forgotten when stamps jump back, as in a simulation that restarts.
    """

    def __init__(self, on_change: Callable[[], None] | None = None, ignored: frozenset[str] = frozenset()) -> None:
        self._on_change = on_change
        self._ignored = ignored
        self._static: list[Any] = []
        self._newest = rospy.Time(0)
        self._buffer = tf2_ros.BufferCore(rospy.Duration(10.0))
        rospy.Subscriber("/tf_static", TFMessage, self._take_static, queue_size=100)
        rospy.Subscriber("/tf", TFMessage, self._take, queue_size=200, tcp_nodelay=True)

    def lookup(self, target: str, source: str, stamp: rospy.Time) -> Any | None:
        """The geometry_msgs/Transform that takes what is in frame `source` to frame `target`, or None.

        Stamp zero means the newest there is.
        """
        try:
            return self._buffer.lookup_transform_core(target, source, stamp).transform
        except tf2_ros.TransformException:
            return None

    def _take_static(self, message: TFMessage) -> None:
        for transform in message.transforms:
            self._static.append(transform)
            self._buffer.set_transform_static(transform, "tf_static")
        self._changed()

    def _take(self, message: TFMessage) -> None:
        used = False
        for transform in message.transforms:
            if transform.child_frame_id.lstrip("/") not in self._ignored:
                self._watch_clock(transform.header.stamp)
                self._buffer.set_transform(transform, "tf")
                used = True
        if used:
            self._changed()

    def _watch_clock(self, stamp: rospy.Time) -> None:
        if (self._newest - stamp).to_sec() > JUMP:
            self._buffer.clear()
            for transform in self._static:
                self._buffer.set_transform_static(transform, "tf_static")
            self._newest = stamp
        self._newest = max(self._newest, stamp)

    def _changed(self) -> None:
        if self._on_change:
            self._on_change()
