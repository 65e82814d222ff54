from __future__ import annotations

import io
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rospy", reason="ROS is not installed")
from PIL import Image
from sensor_msgs.msg import CompressedImage

from ur_nodes.pictures.decode import BadPictureError
from ur_nodes.web.layers.camera_node import CameraView, choose_camera, compress, list_cameras

RAW, JPEG = "sensor_msgs/Image", "sensor_msgs/CompressedImage"


def test_cameras_are_compressed_before_raw_pictures_and_each_only_once() -> None:
    topics = [
        ("/z/image", RAW),
        ("/scan", "sensor_msgs/LaserScan"),
        ("/rear/image/compressed", JPEG),
        ("/front/image", RAW),
        ("/front/image/compressed", JPEG),
        ("/front/image/theora", "theora_image_transport/Packet"),
        ("/depth/image/compressedDepth", JPEG),
        ("/<img>", RAW),
    ]
    found = {"/front/image/compressed": JPEG, "/rear/image/compressed": JPEG, "/z/image": RAW}
    assert list(list_cameras(topics).items()) == list(found.items())
    assert list_cameras(topics[1:2]) == {}
    assert len(list_cameras((f"/camera_{number}", RAW) for number in range(1000))) == 20


@pytest.mark.parametrize(
    ("preferred", "chosen"),
    [((), "/a"), (("/b",), "/b"), (("/b", "/a"), "/b"), (("", "/b"), "/b"), (("/x", "/b"), "/b"), (("/x",), "/a")],
)
def test_chosen_camera_is_shown_while_there_is_one_of_the_name(preferred: tuple[str, ...], chosen: str) -> None:
    assert choose_camera({"/a": JPEG, "/b": RAW}, preferred) == chosen
    assert choose_camera({}, preferred) == ""


class Robot:
    """Cameras, a view of them, and the frames that it sends."""

    def __init__(self) -> None:
        self.topics = [("/b/compressed", JPEG), ("/c/compressed", JPEG)]
        self.callbacks: dict[str, Any] = {}
        self.connected, self.frames, self.now = True, list[bytes](), 10.0
        self.view = CameraView(self.frames.append, lambda: self.topics, self.subscribe)

    def subscribe(self, topic: str, _kind: Any, callback: Any, argument: str, **_: int) -> Any:
        self.callbacks[topic] = lambda message: callback(message, argument)
        return SimpleNamespace(
            unregister=lambda: self.callbacks.pop(topic), get_num_connections=lambda: int(self.connected)
        )

    def step(self, topic: str = "", seconds: float = 5.0) -> tuple[str, list[str]]:
        """The topic that is shown and those that are offered, after a request and some seconds."""
        self.view.want(topic, wanted=True)
        self.now += seconds
        self.view.step(self.now)
        shown = self.view.describe()["topic"]
        assert list(self.callbacks) == ([shown] if shown else [])
        return shown, self.view.describe()["topics"]


def test_camera_is_changed_at_once_and_an_unknown_one_changes_nothing() -> None:
    robot, both = Robot(), ["/b/compressed", "/c/compressed"]
    assert robot.step() == (both[0], both)
    assert robot.step("/c/compressed", 0.1) == (both[1], both)
    assert robot.step("/etc/passwd", 0.1) == (both[1], both)
    robot.topics.append(("/a/compressed", JPEG))
    assert robot.step()[0] == both[1], "a camera that is new does not replace the one that is shown"
    robot.view.want("", wanted=False)
    robot.view.step(robot.now)
    assert (robot.view.describe(), robot.callbacks) == ({"topic": "", "topics": []}, {})


def test_chosen_camera_is_shown_again_when_it_is_back_and_one_that_answers_without_the_master() -> None:
    robot = Robot()
    robot.step("/c/compressed")
    both, robot.topics = robot.topics, []
    assert robot.step("/c/compressed") == ("/c/compressed", ["/b/compressed", "/c/compressed"])
    robot.connected = False
    assert robot.step("/c/compressed") == ("", [])
    robot.topics, robot.connected = both[:1], True
    assert robot.step("/c/compressed")[0] == "/b/compressed"
    robot.topics = both
    assert robot.step("/c/compressed")[0] == "/c/compressed"


def test_late_picture_of_the_camera_before_is_not_sent() -> None:
    robot = Robot()
    robot.step("/b/compressed")
    late = robot.callbacks["/b/compressed"]
    robot.step("/c/compressed")
    message = CompressedImage(format="jpeg", data=b"\xff\xd8")
    late(message)
    assert robot.frames == []
    robot.callbacks["/c/compressed"](message)
    assert len(robot.frames) == 1


def test_raw_pictures_become_small_jpegs() -> None:
    pixels = np.zeros((720, 1280, 3), np.uint8)
    pixels[:, :640] = (200, 30, 30)
    message = SimpleNamespace(data=pixels.tobytes(), width=1280, height=720, step=3840, encoding="rgb8")
    data = compress(message)
    picture = Image.open(io.BytesIO(data))
    assert (picture.format, picture.size) == ("JPEG", (640, 360))
    red, _, _ = picture.convert("RGB").getpixel((10, 10))  # type: ignore[misc]
    assert red > 150
    with pytest.raises(BadPictureError):
        compress(SimpleNamespace(data=b"", width=1280, height=720, step=3840, encoding="rgb8"))
