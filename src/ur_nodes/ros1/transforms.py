"""The topics /tf and /tf_static."""

from __future__ import annotations

from collections.abc import Callable

import rospy
from tf2_msgs.msg import TFMessage

from ur_nodes.codecs.frames import Newest, fill_transforms, transforms_of
from ur_nodes.ports.values import Transform
from ur_nodes.ros1.ending import quiet_at_end

_Callback = Callable[[tuple[Transform, ...]], None]


class TransformTopics:
    """Sends and receives transforms. Each publisher is made for its first transform."""

    def __init__(self) -> None:
        self._moving: rospy.Publisher | None = None
        self._newest = Newest()
        self._fixed: rospy.Publisher | None = None
        self._kept: dict[str, Transform] = {}  # a latched topic keeps one message: all fixed ones go together

    def listen(self, callback: _Callback, fixed_callback: _Callback) -> None:
        """Pass all transforms to functions, on any thread; fixed ones arrive once, and must not be lost."""
        rospy.Subscriber(
            "/tf_static", TFMessage, lambda message: fixed_callback(transforms_of(message, fixed=True)), queue_size=100
        )
        rospy.Subscriber(
            "/tf", TFMessage, lambda message: callback(transforms_of(message)), queue_size=200, tcp_nodelay=True
        )

    @quiet_at_end
    def send(self, transforms: tuple[Transform, ...]) -> None:
        """Send transforms together."""
        fixed = {each.child: each for each in transforms if each.fixed}
        moving = tuple(each for each in transforms if not each.fixed)
        if fixed:
            self._kept |= fixed
            self._fixed = self._fixed or rospy.Publisher("/tf_static", TFMessage, queue_size=100, latch=True)
            self._fixed.publish(_message(tuple(self._kept.values())))
        if moving:
            self._newest.note(moving)
            self._moving = self._moving or self._offer()
            self._moving.publish(_message(moving))

    def _offer(self) -> rospy.Publisher:
        publisher = rospy.Publisher("/tf", TFMessage, queue_size=100, tcp_nodelay=True)
        publisher.impl.add_subscriber_listener(_Greeter(publisher.impl, self._newest))
        return publisher


class _Greeter(rospy.SubscribeListener):
    """Sends the newest moving transforms to each new subscriber, and to no other one, on a thread of rospy's."""

    def __init__(self, implementation: rospy.topics._PublisherImpl, newest: Newest) -> None:
        super().__init__()
        self._implementation, self._newest = implementation, newest

    def peer_subscribe(self, _name: str, _send_all: object, send: Callable[[TFMessage], None]) -> None:
        """See rospy."""
        if transforms := self._newest.get():
            self._implementation.acquire()  # as rospy does for messages that it has latched
            try:
                send(_message(transforms))
            finally:
                self._implementation.release()


def _message(transforms: tuple[Transform, ...]) -> TFMessage:
    message = TFMessage()
    fill_transforms(message, transforms)
    return message
