"""The picture of the robot's camera for pages, subscribed to while a page shows it."""

from __future__ import annotations

import io
import threading
import time
from collections.abc import Callable
from typing import Any

import rospy
from sensor_msgs.msg import CompressedImage, Image

from ur.web.wire.frames import LONGEST, camera_frame
from ur_nodes.pictures.decode import BadPictureError, unpack_picture
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.web.layers.topic_list_node import list_topics

_EVERY = 1.0 / 15.0  # s between two pictures
_LOOK_EVERY = 2.0  # s between two looks for a camera
_WIDEST = 640  # pixels of a picture that is compressed here
_QUALITY = 70  # of JPEG
_BUFFER = 1 << 24  # bytes of one message
_JPEG = b"\xff\xd8"
_KINDS = {"sensor_msgs/CompressedImage": CompressedImage, "sensor_msgs/Image": Image}


class CameraView:
    """Sends the newest picture of one camera: JPEG passes through, raw pictures are compressed here.

    `send` is called from threads of rospy. It may block: pictures that come meanwhile are dropped but for the newest.
    """

    def __init__(self, send: Callable[[bytes], None]) -> None:
        self._send = send
        self._lock = threading.Lock()
        self._wanted = False
        self._subscriber: rospy.Subscriber | None = None
        self._look_at = float("-inf")
        self._due = float("-inf")

    def want(self, *, wanted: bool) -> None:
        """Have pictures sent, or none."""
        self._wanted = wanted

    def step(self, now: float) -> None:
        """Subscribe to what is wanted; to be called often, from one thread. `now` is time.monotonic()."""
        if not self._wanted:
            self._drop()
        elif now >= self._look_at and (self._subscriber is None or not self._subscriber.get_num_connections()):
            self._look_at = now + _LOOK_EVERY
            self._drop()
            found = choose_topic(list_topics())
            if found is not None:
                topic, kind = found
                self._subscriber = rospy.Subscriber(
                    topic, _KINDS[kind], self._on_picture, queue_size=1, buff_size=_BUFFER
                )

    def _drop(self) -> None:
        if self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber = None

    @quiet_at_end
    def _on_picture(self, message: Any) -> None:
        with self._lock:
            now = time.monotonic()
            if not self._wanted or now < self._due:
                return
            self._due = max(self._due + _EVERY, now)
            try:
                data = bytes(message.data) if isinstance(message, CompressedImage) else compress(message)
            except BadPictureError as problem:
                rospy.logwarn_throttle(10.0, f"camera: {problem}")
                return
            frame = camera_frame(message.header.stamp.to_sec(), data)
            if data.startswith(_JPEG) and len(frame) <= LONGEST:
                self._send(frame)


def choose_topic(topics: list[tuple[str, str]]) -> tuple[str, str] | None:
    """Choose a camera among topics and their types: compressed before raw, then by name; None: there is none."""
    found = [(name, kind) for name, kind in topics if kind in _KINDS]
    compressed = [(name, kind) for name, kind in found if kind == "sensor_msgs/CompressedImage"]
    return min(compressed or found, default=None)


def compress(message: Any) -> bytes:
    """The JPEG of a sensor_msgs/Image, not wider than a page needs. Raises BadPictureError."""
    from PIL import Image as Picture

    pixels = unpack_picture(message.data, message.width, message.height, message.step, message.encoding)
    step = max(1, -(-message.width // _WIDEST))
    buffer = io.BytesIO()
    Picture.fromarray(pixels[::step, ::step]).save(buffer, "JPEG", quality=_QUALITY)
    return buffer.getvalue()
