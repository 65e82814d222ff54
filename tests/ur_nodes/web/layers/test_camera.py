import io
from typing import Any

import numpy as np
import pytest
from PIL import Image

from ur_nodes.memory.bus import Bus
from ur_nodes.pictures.decode import BadPictureError
from ur_nodes.ports.values import PackedPicture, Picture
from ur_nodes.web.layers.camera import CameraView, choose_camera, compress, list_cameras

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


class CameraRobot:
    """Cameras, a view of them, and the frames that it sends."""

    def __init__(self) -> None:
        self.bus, self.topics = Bus(), [("/b/compressed", JPEG), ("/c/compressed", JPEG)]
        self.node, self.cameras = self.bus.node("web"), self.bus.node("cameras")
        self.frames, self.busy = list[bytes](), False
        self.publishers = {
            name: self.cameras.publish(name, PackedPicture)
            for name in ("/a/compressed", "/b/compressed", "/c/compressed")
        }
        self.view = CameraView(self.node, self)

    def send_frame(self, frame: bytes) -> None:
        self.frames.append(frame)

    def send(self, topic: str, data: bytes = b"\xff\xd8") -> None:
        self.publishers[topic].send(PackedPicture(0, "camera", "jpeg", data))

    def step(self, topic: str = "", *, listed: bool = True) -> tuple[str, list[str]]:
        """The topic that is shown and those that are offered, after a request and some seconds."""
        self.view.want(topic, wanted=True)
        if listed:
            self.view.update_topics(self.topics)
        self.view.step()
        self.bus.run(5.0)
        state: Any = self.view.describe()
        shown = state["topic"]
        assert [name for name, each in self.publishers.items() if each.subscribers()] == ([shown] if shown else [])
        return shown, state["topics"]

    def end_cameras(self) -> None:
        self.cameras.end("unplugged")


def test_camera_is_changed_at_once_and_an_unknown_one_changes_nothing() -> None:
    robot, both = CameraRobot(), ["/b/compressed", "/c/compressed"]
    assert robot.step() == (both[0], both)
    assert robot.step("/c/compressed", listed=False) == (both[1], both)
    assert robot.step("/etc/passwd", listed=False) == (both[1], both)
    robot.topics.append(("/a/compressed", JPEG))
    assert robot.step()[0] == both[1], "a camera that is new does not replace the one that is shown"
    robot.view.want("", wanted=False)
    robot.view.step()
    assert robot.view.describe() == {"topic": "", "topics": []}
    assert robot.publishers["/c/compressed"].subscribers() == 0


def test_chosen_camera_is_shown_again_when_it_is_back_and_one_that_answers_without_the_master() -> None:
    robot = CameraRobot()
    robot.step("/c/compressed")
    both, robot.topics = robot.topics, []
    assert robot.step("/c/compressed") == ("/c/compressed", ["/b/compressed", "/c/compressed"])
    robot.end_cameras()
    assert robot.step("/c/compressed") == ("", [])
    robot.topics = both[:1]
    assert robot.step("/c/compressed")[0] == "/b/compressed"
    robot.topics = both
    assert robot.step("/c/compressed")[0] == "/c/compressed"


def test_late_picture_of_the_camera_before_is_not_sent() -> None:
    robot = CameraRobot()
    robot.step("/b/compressed")
    robot.send("/b/compressed")
    robot.step("/c/compressed")
    assert robot.frames == []
    robot.send("/c/compressed")
    robot.bus.run(1.0)
    assert len(robot.frames) == 1


def test_pictures_are_left_out_while_the_server_is_slow_and_when_they_are_no_jpeg() -> None:
    robot = CameraRobot()
    robot.step("/b/compressed")
    robot.busy = True
    robot.send("/b/compressed")
    robot.bus.run(1.0)
    assert robot.frames == []
    robot.busy = False
    robot.send("/b/compressed", b"GIF89a")
    robot.bus.run(1.0)
    assert robot.frames == []
    robot.cameras.every(0.01, lambda: robot.send("/b/compressed"))
    robot.bus.run(1.0)
    assert 13 <= len(robot.frames) <= 16


def test_picture_that_arrives_while_the_server_is_busy_is_sent_once_it_is_not() -> None:
    robot = CameraRobot()
    robot.step("/b/compressed")
    robot.busy = True
    robot.send("/b/compressed", b"\xff\xd8 old")
    robot.send("/b/compressed", b"\xff\xd8 new")
    robot.step("/b/compressed")
    assert robot.frames == []
    robot.busy = False
    robot.step("/b/compressed")
    assert [each.endswith(b"new") for each in robot.frames] == [True]


def test_newest_picture_is_sent_after_the_one_that_is_on_its_way() -> None:
    robot = CameraRobot()
    robot.bus.durations["camera"] = 0.5
    robot.step("/b/compressed")
    for data in (b"\xff\xd8 1", b"\xff\xd8 2", b"\xff\xd8 3"):
        robot.send("/b/compressed", data)
        robot.bus.run(0.1)
    robot.bus.run(2.0)
    assert [each[-1:] for each in robot.frames] == [b"1", b"3"]


@pytest.mark.parametrize(("width", "height"), [(0, 0), (0, 2), (5, 0), (1, 70_000)])
def test_raw_picture_of_an_odd_size_is_reported_and_the_next_one_is_shown(width: int, height: int) -> None:
    robot = CameraRobot()
    raw = robot.cameras.publish("/raw", Picture)
    robot.view.want("", wanted=True)
    robot.view.update_topics([("/raw", RAW)])
    robot.view.step()
    raw.send(Picture(0, "camera", width, height, "rgb8", 3 * width, bytes(3 * width * height)))
    robot.bus.run(1.0)
    assert any(f"{width} x {height}" in text for _, text in robot.node.lines)
    raw.send(Picture(0, "camera", 4, 4, "rgb8", 12, bytes(48)))
    robot.bus.run(1.0)
    assert len(robot.frames) == 1


def test_raw_pictures_become_small_jpegs() -> None:
    pixels = np.zeros((720, 1280, 3), np.uint8)
    pixels[:, :640] = (200, 30, 30)
    data = compress(Picture(0, "camera", 1280, 720, "rgb8", 3840, pixels.tobytes()))
    picture = Image.open(io.BytesIO(data))
    assert (picture.format, picture.size) == ("JPEG", (640, 360))
    red, _, _ = picture.convert("RGB").getpixel((10, 10))  # type: ignore[misc]
    assert red > 150
    with pytest.raises(BadPictureError):
        compress(Picture(0, "camera", 1280, 720, "rgb8", 3840, b""))


def test_picture_that_cannot_be_read_is_reported_and_the_next_one_is_shown() -> None:
    robot = CameraRobot()
    robot.topics = [("/raw", RAW)]
    raw = robot.cameras.publish("/raw", Picture)
    robot.view.want("", wanted=True)
    robot.view.update_topics(robot.topics)
    robot.view.step()
    raw.send(Picture(0, "camera", 4, 4, "rgb8", 12, b""))
    robot.bus.run(1.0)
    assert any("camera: 0 bytes" in text for _, text in robot.node.lines)
    raw.send(Picture(0, "camera", 4, 4, "rgb8", 12, bytes(48)))
    robot.bus.run(1.0)
    assert len(robot.frames) == 1
