"""The node raspicam_node over real ROS, with cameras that answer as V4L2 does."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ros_session import RosSession
from tests.ur_nodes.camera.fake_device import make_jpeg

from ur_nodes.camera.calibration_file import read_calibration

pytestmark = [pytest.mark.ros, pytest.mark.timeout(300)]

JPEG = make_jpeg(640, 480)
FAKE = str(Path(__file__).with_name("fake_camera_node.py"))


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RosSession]:
    folder = tmp_path_factory.mktemp("camera")
    (folder / "picture.jpg").write_bytes(JPEG)
    started = RosSession(folder, [sys.executable, str(Path(__file__).with_name("camera_client_node.py"))])
    try:
        yield started
    finally:
        started.close()


def start(session: RosSession, count: int, name: str, *arguments: str) -> subprocess.Popen[str]:
    picture = str(Path(session.env["ROS_HOME"]) / "picture.jpg")
    return session.start(sys.executable, FAKE, str(count), "20", picture, "", f"__name:={name}", *arguments)


def tell(node: subprocess.Popen[str], line: str) -> None:
    assert node.stdin
    node.stdin.write(f"{line}\n")
    node.stdin.flush()


def test_pictures_are_passed_on_unplugged_and_back_and_paused(session: RosSession) -> None:
    node = start(session, 1, "raspicam_node")
    for topic in ("image/compressed", "image", "camera_info"):
        session.ask("listen", topic=f"/raspicam_node/{topic}")
    seen = session.ask("wait", topic="/raspicam_node/image/compressed", count=3)
    assert seen["hash"] == hashlib.sha256(JPEG).hexdigest()
    assert (seen["frame"], seen["format"]) == ("raspicam", "jpeg")
    assert 0.0 <= seen["age"] < 5.0
    raw = session.ask("wait", topic="/raspicam_node/image", count=1)
    assert (raw["size"], raw["encoding"]) == ([640, 480], "rgb8")
    info = session.ask("wait", topic="/raspicam_node/camera_info", count=1)
    assert (info["size"], info["focal"], info["frame"]) == ([640, 480], 0.0, "raspicam")
    session.ask("leave", topic="/raspicam_node/image")
    tell(node, "unplug 0")
    tell(node, "plug 0")
    session.ask("wait", topic="/raspicam_node/image/compressed", count=10)
    session.ask("call", service="/raspicam_node/stop_capture")
    tell(node, "busy 0")  # another program may have it now
    session.ask("call", service="/raspicam_node/start_capture")
    tell(node, "unplug 0")
    tell(node, "plug 0")
    session.ask("wait", topic="/raspicam_node/image/compressed", count=2)
    assert "Traceback" not in session.stop(node)


@pytest.mark.long
def test_calibration_is_stored_used_at_once_and_loaded_again(session: RosSession) -> None:
    node = start(session, 1, "left")
    session.ask("listen", topic="/left/camera_info")
    path = Path(session.env["ROS_HOME"]) / "camera_info" / "left.yaml"
    assert session.ask("set", service="/left/set_camera_info", width=640, focal=0.0)[0] is False
    assert session.ask("set", service="/left/set_camera_info", width=640, focal=530.5) == [True, f"written to {path}"]
    assert session.ask("wait", topic="/left/camera_info", count=2)["focal"] == 530.5
    session.stop(node)
    assert read_calibration(path).camera_matrix[0] == 530.5
    again = start(session, 1, "left")
    assert session.ask("wait", topic="/left/camera_info", count=1)["focal"] == 530.5
    # A calibration of pictures of another size is kept, and not used.
    assert session.ask("set", service="/left/set_camera_info", width=1280, focal=900.0)[0] is True
    assert session.ask("wait", topic="/left/camera_info", count=2)["focal"] == 0.0
    session.stop(again)


@pytest.mark.long
def test_two_nodes_of_two_cameras_publish_side_by_side(session: RosSession) -> None:
    nodes = [start(session, 2, f"camera_{number}", f"_camera_id:={number}") for number in range(2)]
    for number in range(2):
        session.ask("listen", topic=f"/camera_{number}/image/compressed")
    for number in range(2):
        session.ask("wait", topic=f"/camera_{number}/image/compressed", count=5)
    for node in nodes:
        session.stop(node)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["_width:=0"], "width: 0, expected a whole number of at least 16"),
        (["_device:=/dev/null"], "/dev/null is no camera"),
    ],
)
def test_node_refuses_what_it_cannot_use_in_one_clear_message(
    session: RosSession, arguments: list[str], message: str
) -> None:
    command = (sys.executable, "-m", "ur_nodes", "ur_nodes.camera.raspicam_node")
    node = session.start(*command, f"__name:=refused{arguments[0].partition(':')[0]}", *arguments)
    _, errors = node.communicate(timeout=90)
    session.running.remove(node)
    assert node.returncode == 2
    assert message in errors
    assert "Traceback" not in errors
