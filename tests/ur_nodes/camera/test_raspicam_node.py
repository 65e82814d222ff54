"""The node raspicam_node on a bus, with cameras that answer as V4L2 does."""

import functools
from pathlib import Path

import numpy as np
import pytest
from tests.ur_nodes.camera.fake_camera_node import ComputerWithCameras
from tests.ur_nodes.camera.fake_device import make_jpeg

from ur.source.diagnostic import UserError
from ur_nodes.camera.calibration_file import read_calibration
from ur_nodes.camera.camera_topics import make_shot
from ur_nodes.camera.loop import CAMERA
from ur_nodes.camera.raspicam_node import RaspicamNode
from ur_nodes.camera.source import Frame
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.services import Silent, UseCalibration
from ur_nodes.ports.values import Calibration, PackedPicture, Picture, Result

JPEG = make_jpeg(640, 480)
KINDS = {"image/compressed": PackedPicture, "image": Picture, "camera_info": Calibration}


def calibration(width: int, focal: float) -> Calibration:
    matrix = (focal, 0.0, 319.5, 0.0, focal, 239.5, 0.0, 0.0, 1.0)
    projection = (*matrix[:3], 0.0, *matrix[3:6], 0.0, *matrix[6:], 0.0)
    square = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    return Calibration(0, "", width, 480, "plumb_bob", (0.0,) * 5, matrix, square, projection)


class RaspicamStage:
    """A computer with cameras, its nodes on a bus, and a client; each use of a camera takes 0.1 s."""

    def __init__(self, folder: Path, cameras: int = 1) -> None:
        devices = folder / "dev"
        devices.mkdir(exist_ok=True)
        self.computer = ComputerWithCameras(cameras, 0.0, "", devices, patient=False)
        self.bus = Bus()
        self.bus.durations[CAMERA] = 0.1
        self.client = self.bus.node("client")
        self.newest: dict[str, object] = {}

    def start(self, name: str) -> None:
        RaspicamNode(self.bus.node(name), self.computer.system())

    def listen(self, node: str, *topics: str) -> None:
        for topic in topics:
            full = f"{node}/{topic}"
            self.client.subscribe(full, KINDS[topic], functools.partial(self.newest.__setitem__, full))

    def take_picture(self, data: bytes = JPEG) -> dict[str, object]:
        """What is published of a picture."""
        self.newest.clear()
        self.bus.run(1.0)
        self.computer.feed(data)
        self.bus.run(1.0)
        return dict(self.newest)

    def ask(self, service: str, request: object) -> Result:
        got: list[Result] = []
        self.client.call(service, request, got.append)
        self.bus.run(2.0)
        return got[0]


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RaspicamStage:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    return RaspicamStage(tmp_path, 2)


def test_picture_is_passed_on_unpacked_and_described(stage: RaspicamStage) -> None:
    stage.start("raspicam_node")
    stage.listen("raspicam_node", *KINDS)
    before = stage.bus.now
    seen = stage.take_picture()
    packed, raw, info = (seen[f"raspicam_node/{topic}"] for topic in KINDS)
    assert isinstance(packed, PackedPicture)
    assert (packed.frame, packed.format, packed.data) == ("raspicam", "jpeg", JPEG)
    assert before < packed.stamp <= stage.bus.now
    assert isinstance(raw, Picture)
    assert (raw.width, raw.height, raw.encoding, raw.stamp) == (640, 480, "rgb8", packed.stamp)
    assert isinstance(info, Calibration)
    assert (info.width, info.height, info.matrix[0], info.frame) == (640, 480, 0.0, "raspicam")
    assert info.stamp == packed.stamp


def test_pictures_go_on_after_the_camera_was_unplugged(stage: RaspicamStage) -> None:
    stage.start("raspicam_node")
    stage.listen("raspicam_node", "image/compressed")
    stage.computer.unplug(0)
    assert stage.take_picture() == {}
    stage.computer.plug(0)
    stage.bus.run(3.0)
    assert "raspicam_node/image/compressed" in stage.take_picture()
    lines = [text for _, text in stage.bus.nodes["/raspicam_node"].lines]
    assert "the camera Fake Camera (/dev/video0) was unplugged" in lines


def test_camera_that_is_not_captured_is_free_for_other_programs(stage: RaspicamStage) -> None:
    stage.start("raspicam_node")
    stage.listen("raspicam_node", "image/compressed")
    assert stage.ask("raspicam_node/stop_capture", Silent()).success
    stage.computer.busy(0)  # another program may have it now
    assert stage.take_picture() == {}
    assert stage.ask("raspicam_node/start_capture", Silent()).success
    assert stage.take_picture() == {}
    stage.computer.unplug(0)
    stage.computer.plug(0)
    stage.bus.run(3.0)
    assert "raspicam_node/image/compressed" in stage.take_picture()


def test_picture_that_cannot_be_decoded_is_left_out_where_it_is_raw(stage: RaspicamStage) -> None:
    stage.start("raspicam_node")
    stage.listen("raspicam_node", "image/compressed", "image")
    assert set(stage.take_picture(JPEG[:2000] + b"\xff\xd9")) >= {"raspicam_node/image/compressed"}
    assert set(stage.take_picture(b"\xff\xd8\xff\xd9")) == {"raspicam_node/image/compressed"}
    lines = stage.bus.nodes["/raspicam_node"].lines
    assert any(level == "warn" and text.startswith("a picture is left out: ") for level, text in lines)


def test_calibration_is_stored_used_at_once_and_loaded_again(stage: RaspicamStage, tmp_path: Path) -> None:
    stage.start("left")
    stage.listen("left", "camera_info")
    path = tmp_path / "camera_info" / "left.yaml"
    assert stage.ask("left/set_camera_info", UseCalibration(calibration(640, 0.0))).success is False
    written = Result(True, f"written to {path}")
    assert stage.ask("left/set_camera_info", UseCalibration(calibration(640, 530.5))) == written
    assert focal(stage) == 530.5
    assert read_calibration(path).matrix[0] == 530.5
    stage.bus.nodes["/left"].end("done")
    stage.start("left")
    assert focal(stage) == 530.5
    # A calibration of pictures of another size is kept, and not used.
    assert stage.ask("left/set_camera_info", UseCalibration(calibration(1280, 900.0))) == written
    assert focal(stage) == 0.0


def focal(stage: RaspicamStage) -> float:
    """That of what is published with a picture."""
    info = stage.take_picture()["left/camera_info"]
    assert isinstance(info, Calibration)
    return info.matrix[0]


def test_calibration_that_cannot_be_written_is_refused(stage: RaspicamStage, tmp_path: Path) -> None:
    stage.start("left")
    (tmp_path / "camera_info").write_text("a file where a folder should be")
    result = stage.ask("left/set_camera_info", UseCalibration(calibration(640, 530.5)))
    assert not result.success
    assert "expected a file that this user can write" in result.text


def test_two_nodes_of_two_cameras_publish_side_by_side(stage: RaspicamStage) -> None:
    for number in range(2):
        stage.bus.parameters[f"/camera_{number}/camera_id"] = number
        stage.start(f"camera_{number}")
        stage.listen(f"camera_{number}", "image/compressed")
    assert set(stage.take_picture()) == {"camera_0/image/compressed", "camera_1/image/compressed"}


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("width", 0, "width: 0, expected a whole number of at least 16"),
        ("device", "/dev/null", "/dev/null is no camera"),
        ("camera_name", "../left", "camera_name: '../left', expected letters, digits, _, - and dots"),
    ],
)
def test_node_refuses_what_it_cannot_use(tmp_path: Path, name: str, value: object, message: str) -> None:
    bus = Bus()
    bus.parameters |= {f"/refused/{name}": value, "/refused/camera_info_url": str(tmp_path / "none.yaml")}
    with pytest.raises(UserError, match=message):
        RaspicamNode(bus.node("refused"))


def test_picture_is_made_in_the_forms_that_are_wanted() -> None:
    pixels = np.full((48, 64, 3), 100, np.uint8)
    shot = make_shot(Frame(0.5, pixels=pixels), packed=True, raw=False, quality=80)
    assert shot.jpeg[:2] == b"\xff\xd8"
    assert shot.pixels is None
    assert 0.5 <= shot.age < 1.5
    shot = make_shot(Frame(0.5, pixels=pixels), packed=False, raw=True, quality=80)
    assert (shot.jpeg, shot.pixels is pixels) == (b"", True)
    assert make_shot(Frame(0.0), packed=True, raw=True, quality=80).jpeg == b""
