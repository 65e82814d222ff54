"""The topics /tf and /tf_static. Their messages are written and read as bytes: tf2_msgs need not be installed."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from ur_nodes.codecs.dialect import Transforms
from ur_nodes.codecs.frames import Newest, fill_transforms, transforms_of
from ur_nodes.ports.values import Transform
from ur_nodes.ros2.ends import MessageSender, Receiver

_Callback = Callable[[tuple[Transform, ...]], None]

_MOVING = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
_FIXED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_FIXED_TAKEN = QoSProfile(
    depth=100, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)


class TransformTopics:
    """Sends and receives transforms. Publishers are made with the first transform of their kind."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._moving: MessageSender | None = None
        self._newest = Newest()
        self._fixed: MessageSender | None = None
        self._kept: dict[str, Transform] = {}  # a latched topic keeps one message: all fixed ones go together

    def listen(self, callback: _Callback, fixed_callback: _Callback) -> None:
        """Pass all transforms to a function, on any thread; static ones are sent once, and must not be lost."""
        Receiver(
            self._node, Transforms, "/tf_static", _FIXED_TAKEN, lambda m: fixed_callback(transforms_of(m, fixed=True))
        )
        Receiver(self._node, Transforms, "/tf", _MOVING, lambda message: callback(transforms_of(message)))

    def send(self, transforms: tuple[Transform, ...]) -> None:
        """Send transforms together."""
        fixed = {each.child: each for each in transforms if each.fixed}
        moving = tuple(each for each in transforms if not each.fixed)
        if fixed:
            self._kept |= fixed
            self._fixed = self._fixed or MessageSender(self._node, Transforms, "/tf_static", _FIXED)
            self._fixed.send(_message(tuple(self._kept.values())))
        if moving:
            self._newest.note(moving)
            self._moving = self._moving or MessageSender(self._node, Transforms, "/tf", _MOVING, self._greet)
            self._moving.send(_message(moving))

    def _greet(self) -> None:
        """Send the newest moving transforms again: nodes that have them ignore them."""
        if self._moving is not None and (transforms := self._newest.get()):
            self._moving.send(_message(transforms))


def _message(transforms: tuple[Transform, ...]) -> Transforms:
    message = Transforms()
    fill_transforms(message, transforms)
    return message
