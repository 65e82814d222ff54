"""The picture of the robot's camera for pages, subscribed to while a page shows it."""

from __future__ import annotations

import io
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import rospy
from sensor_msgs.msg import CompressedImage, Image

from ur.web.wire.frames import LONGEST, camera_frame
from ur.web.wire.layers import is_camera_topic
from ur_nodes.pictures.decode import BadPictureError, unpack_picture
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.web.layers.pacing import Every

_EVERY = 1.0 / 15.0  # s between two pictures
_LOOK_EVERY = 2.0  # s between two looks for cameras
_MOST = 20  # cameras that pages choose among
_WIDEST = 640  # pixels of a picture that is compressed here
_QUALITY = 70  # of JPEG
_BUFFER = 1 << 24  # bytes of one message
_JPEG = b"\xff\xd8"
_KINDS = {"sensor_msgs/CompressedImage": CompressedImage, "sensor_msgs/Image": Image}  # the preferred one first
_COMPRESSED, _DEPTH = "/compressed", "/compressedDepth"  # how image_transport ends the names of topics


class CameraView:
    """Sends the newest picture of one camera: JPEG passes through, raw pictures are compressed here.

    `send` is called from threads of rospy. It may block: pictures that come meanwhile are dropped but for the newest.
    `list_topics` lists names and types of topics; `subscribe` makes subscribers as rospy.Subscriber does.
    """

    def __init__(
        self,
        send: Callable[[bytes], None],
        list_topics: Callable[[], Sequence[tuple[str, str]]],
        subscribe: Callable[..., Any] = rospy.Subscriber,
    ) -> None:
        self._send, self._list_topics, self._subscribe = send, list_topics, subscribe
        self._lock = threading.Lock()
        self._wanted = False
        self._asked = self._topic = ""
        self._cameras: dict[str, str] = {}
        self._subscriber: Any = None
        self._look_every = Every(_LOOK_EVERY)
        self._due = float("-inf")

    def want(self, topic: str, *, wanted: bool) -> None:
        """Have pictures sent, or none: those of `topic` while it is a camera's, else those of another camera."""
        changed = (topic, wanted) != (self._asked, self._wanted)
        self._asked, self._wanted = topic, wanted
        if changed:
            self._look_every.hurry()

    def describe(self) -> dict[str, Any]:
        """The topic that is shown, and those that can be chosen: none while no page shows the camera."""
        return {"topic": self._topic, "topics": list(self._cameras)}

    def step(self, now: float) -> None:
        """Subscribe to what is wanted; to be called often, from one thread. `now` is time.monotonic()."""
        if not self._wanted:
            self._drop()
            self._cameras = {}
        elif self._look_every.due(now):
            cameras = list_cameras(self._list_topics())
            connected = self._subscriber is not None and self._subscriber.get_num_connections() > 0
            if not cameras and connected:  # the master does not answer, the camera does
                return
            self._cameras = cameras
            topic = choose_camera(cameras, (self._asked, self._topic if connected else ""))
            if topic != self._topic or not connected:
                self._drop()
            if topic and self._subscriber is None:
                self._topic = topic
                self._subscriber = self._subscribe(
                    topic, _KINDS[cameras[topic]], self._on_picture, topic, queue_size=1, buff_size=_BUFFER
                )

    def _drop(self) -> None:
        if self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber = None
            self._topic = ""

    @quiet_at_end
    def _on_picture(self, message: Any, topic: str) -> None:
        with self._lock:
            now = time.monotonic()
            if not self._wanted or topic != self._topic or now < self._due:
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


def list_cameras(topics: Iterable[tuple[str, str]]) -> dict[str, str]:
    """The topics of cameras and their types: compressed before raw, then by name, and not more than pages list.

    A raw topic is left out where its pictures are published compressed, too, and so are pictures of depth.
    """
    kinds = list(_KINDS)
    found = {name: kind for name, kind in topics if kind in _KINDS and is_camera_topic(name)}
    shown = (name for name in found if not name.endswith(_DEPTH) and name + _COMPRESSED not in found)
    return {name: found[name] for name in sorted(shown, key=lambda name: (kinds.index(found[name]), name))[:_MOST]}


def choose_camera(cameras: Iterable[str], preferred: Iterable[str]) -> str:
    """Choose the first of the preferred topics that is a camera's, else the first camera; "": there is none."""
    found = list(cameras)
    return next((topic for topic in (*preferred, *found) if topic in found), "")


def compress(message: Any) -> bytes:
    """The JPEG of a sensor_msgs/Image, not wider than a page needs. Raises BadPictureError."""
    from PIL import Image as Picture

    pixels = unpack_picture(message.data, message.width, message.height, message.step, message.encoding)
    step = max(1, -(-message.width // _WIDEST))
    buffer = io.BytesIO()
    Picture.fromarray(pixels[::step, ::step]).save(buffer, "JPEG", quality=_QUALITY)
    return buffer.getvalue()
