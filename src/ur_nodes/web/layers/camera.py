"""The picture of the robot's camera for pages, subscribed to while a page shows it."""

import io
from collections.abc import Iterable, Sequence
from functools import partial

from ur.web.wire.frames import LONGEST, camera_frame
from ur.web.wire.layers import is_camera_topic
from ur_nodes.pictures.decode import BadPictureError, unpack_picture
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.values import PackedPicture, Picture
from ur_nodes.web.layers.pacing import FrameOutlet

_EVERY = 1.0 / 15.0  # s between two pictures
_MOST = 20  # cameras that pages choose among
_WIDEST = 640  # pixels of a picture that is compressed here
_QUALITY = 70  # of JPEG
_JPEG = b"\xff\xd8"
_KINDS: dict[str, type[PackedPicture] | type[Picture]] = {
    "sensor_msgs/CompressedImage": PackedPicture,  # the preferred one first
    "sensor_msgs/Image": Picture,
}
_COMPRESSED, _DEPTH = "/compressed", "/compressedDepth"  # how image_transport ends the names of topics
_LANE = "camera"


class CameraView:
    """Sends the newest picture of one camera: JPEG passes through, raw pictures are compressed on a worker.

    Of pictures that arrive while one is on its way, or the server is busy, the newest is sent next.
    """

    def __init__(self, node: Node, outlet: FrameOutlet) -> None:
        self._node, self._outlet = node, outlet
        self._topics: Sequence[tuple[str, str]] = ()
        self._wanted = self._busy = False
        self._stale = False  # what is wanted, or the topics, have changed
        self._asked = self._topic = ""
        self._cameras: dict[str, str] = {}
        self._subscription: Subscription | None = None
        self._due = float("-inf")
        self._newest: PackedPicture | Picture | None = None  # that is not on its way yet

    def want(self, topic: str, *, wanted: bool) -> None:
        """Send pictures of `topic`, or of another camera if it is none; without a page, send none."""
        self._stale = self._stale or (topic, wanted) != (self._asked, self._wanted)
        self._asked, self._wanted = topic, wanted

    def update_topics(self, topics: Sequence[tuple[str, str]]) -> None:
        """Take the names and types of all topics."""
        self._topics, self._stale = topics, True

    def describe(self) -> dict[str, object]:
        """Describe the topic that is shown and those to choose from; both are empty while no page shows the camera."""
        return {"topic": self._topic, "topics": list(self._cameras)}

    def step(self) -> None:
        """Subscribe to the chosen camera, and send a picture that had to wait; to be called often."""
        self._follow()
        self._begin()

    def _follow(self) -> None:
        stale, self._stale = self._stale, False
        if not self._wanted:
            self._drop()
            self._cameras = {}
        elif stale:
            cameras = list_cameras(self._topics)
            connected = self._subscription is not None and self._subscription.publishers() > 0
            if not cameras and connected:  # the master does not answer, the camera does
                return
            self._cameras = cameras
            topic = choose_camera(cameras, (self._asked, self._topic if connected else ""))
            if topic != self._topic or not connected:
                self._drop()
            if topic and self._subscription is None:
                self._topic = topic
                self._subscription = self._node.subscribe(topic, _KINDS[cameras[topic]], self._on_picture)

    def _drop(self) -> None:
        if self._subscription is not None:
            self._subscription.close()
            self._subscription = self._newest = None
            self._topic = ""

    def _on_picture(self, picture: PackedPicture | Picture) -> None:
        self._newest = picture
        self._begin()

    def _begin(self) -> None:
        now, picture = self._node.steady(), self._newest
        if picture is not None and not self._busy and not self._outlet.busy and now >= self._due:
            self._due, self._busy, self._newest = max(self._due + _EVERY, now), True, None
            self._node.work(lambda: make_frame(picture), partial(self._pass_on, self._topic), _LANE)

    def _pass_on(self, topic: str, made: bytes | BadPictureError) -> None:
        self._busy = False
        if isinstance(made, BadPictureError):
            self._node.log.warn(f"camera: {made}", every=10.0)
        elif made and topic == self._topic:
            self._outlet.send_frame(made)
        self._begin()


def list_cameras(topics: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Return the topics of cameras and their types, compressed ones first, then by name; as many as pages list.

    A raw topic is left out where its pictures are published compressed, too, and so are pictures of depth.
    """
    kinds = list(_KINDS)
    found = {name: kind for name, kind in topics if kind in _KINDS and is_camera_topic(name)}
    shown = (name for name in found if not name.endswith(_DEPTH) and name + _COMPRESSED not in found)
    return {name: found[name] for name in sorted(shown, key=lambda name: (kinds.index(found[name]), name))[:_MOST]}


def choose_camera(cameras: Iterable[str], preferred: Iterable[str]) -> str:
    """Return the first preferred topic that is a camera's, else the first camera; "" without a camera."""
    found = list(cameras)
    return next((topic for topic in (*preferred, *found) if topic in found), "")


def make_frame(picture: PackedPicture | Picture) -> bytes | BadPictureError:
    """Return the frame of a picture (b"" if pages cannot show it), and the error if it cannot be read."""
    try:
        data = bytes(picture.data) if isinstance(picture, PackedPicture) else compress(picture)
    except BadPictureError as problem:
        return problem
    frame = camera_frame(seconds_of(picture.stamp), data)
    return frame if data.startswith(_JPEG) and len(frame) <= LONGEST else b""


def compress(picture: Picture) -> bytes:
    """Compress a picture as JPEG, at most as wide as a page needs. Raises BadPictureError."""
    from PIL import Image

    pixels = unpack_picture(picture.data, picture.width, picture.height, picture.step, picture.encoding)
    step = max(1, -(-picture.width // _WIDEST))
    buffer = io.BytesIO()
    try:
        Image.fromarray(pixels[::step, ::step]).save(buffer, "JPEG", quality=_QUALITY)
    except (OSError, ValueError) as problem:  # JPEG has 65,500 rows at most
        raise BadPictureError(f"{picture.width} x {picture.height} pixels that are no JPEG: {problem}") from None
    return buffer.getvalue()
