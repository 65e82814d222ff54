"""Unpack compressed pictures: the stand-in for image_transport's republish, for `compressed in:=A raw out:=B`."""

from __future__ import annotations

import sys

import rospy
from sensor_msgs.msg import CompressedImage, Image

from ur.source.diagnostic import UserError, error
from ur_nodes.pictures.decode import BadPictureError, decode_picture
from ur_nodes.rosio.shell import run_node

_NAME = "image_republisher"
_EXPECTED = ["compressed", "raw"]


class Republisher:
    """Publishes `out` from `in/compressed`; subscribes only while it has subscribers."""

    def __init__(self) -> None:
        self._source = rospy.resolve_name("in") + "/compressed"
        self._subscriber: rospy.Subscriber | None = None
        self._publisher = rospy.Publisher("out", Image, subscriber_listener=self, queue_size=1)

    def peer_subscribe(self, _topic: str, _publish: object, _peer_publish: object) -> None:
        """Called by rospy for a new subscriber."""
        if self._subscriber is None:
            self._subscriber = rospy.Subscriber(
                self._source, CompressedImage, self._pass_on, queue_size=1, buff_size=1 << 24
            )

    def peer_unsubscribe(self, _topic: str, count: int) -> None:
        """Called by rospy when a subscriber has gone."""
        if count == 0 and self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber = None

    def _pass_on(self, message: CompressedImage) -> None:
        try:
            pixels = decode_picture(message.data)
        except BadPictureError as problem:
            rospy.logwarn_throttle(10.0, f"{self._source}: {problem}")
            return
        height, width = pixels.shape[:2]
        self._publisher.publish(
            Image(
                header=message.header,
                height=height,
                width=width,
                encoding="rgb8",
                step=3 * width,
                data=pixels.tobytes(),
            )
        )


def start() -> None:
    """Check the arguments and begin."""
    words = rospy.myargv(sys.argv)[1:]
    if words != _EXPECTED:
        given = " ".join(words) or "nothing"
        help_ = "image_transport's own republish knows other transports: n_image_uncompress, image_uncompress_pkg"
        raise UserError(error(f"arguments: {given}, expected {' '.join(_EXPECTED)}", rule="bad-argument", help=help_))
    Republisher()


if __name__ == "__main__":
    sys.exit(run_node(_NAME, start))
