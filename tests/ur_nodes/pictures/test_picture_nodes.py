"""Compressed pictures over real ROS: unpacked for others, and looked at in a terminal or told of in lines."""

import contextlib
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ros_session import RosSession

pytestmark = [pytest.mark.ros, pytest.mark.timeout(300)]

LIMIT = 60.0  # s
LIBRARY = Path(__file__).parents[3] / "ubiquity_launches"
SIMULATOR = LIBRARY / "n_simulator" / "bin" / "simulator"


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RosSession]:
    client = [sys.executable, str(Path(__file__).with_name("camera_client_node.py"))]
    session = RosSession(tmp_path_factory.mktemp("pictures"), client)
    try:
        session.ask("publish")
        yield session
    finally:
        session.close()


@contextlib.contextmanager
def publishing(session: RosSession) -> Iterator[None]:
    """The camera publishes for as long as this lasts; nobody else may ask the client meanwhile."""
    over = threading.Event()

    def publish() -> None:
        while not over.wait(0.05):
            session.ask("publish")

    thread = threading.Thread(target=publish)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join(LIMIT)


def test_without_a_terminal_lines_tell_how_pictures_come(session: RosSession) -> None:
    node = session.start(
        *(sys.executable, "-m", "ur_nodes", "ur_nodes.teleop.camera.image_terminal_node", "_image:=camera/image")
    )
    assert node.stdout
    assert node.stdin
    topic = "/camera/image/compressed"
    with publishing(session):
        line = node.stdout.readline()
        while "x" not in line:
            assert topic in line, line
            line = node.stdout.readline()
    assert line.startswith(f"{topic}   64 x 48   ")
    node.stdin.write("q\n")
    node.stdin.flush()
    _, errors = node.communicate(timeout=LIMIT)
    session.running.remove(node)
    assert (node.returncode, errors) == (0, "")


def test_viewer_shows_why_the_simulated_camera_sends_no_picture(session: RosSession) -> None:
    session.env["PYOPENGL_PLATFORM"] = "none"  # which neither EGL nor OSMesa accepts
    simulator = session.start(str(SIMULATOR), "__name:=simulator", "_base:=magni", f"_package:={LIBRARY}")
    viewer = session.start(
        *(sys.executable, "-m", "ur_nodes", "ur_nodes.teleop.camera.image_terminal_node", "_image:=raspicam_node/image")
    )
    assert viewer.stdout
    expected = "no picture on /raspicam_node/image/compressed for "
    line = viewer.stdout.readline()
    while "cannot draw" not in line:
        assert line, "the viewer has ended"
        line = viewer.stdout.readline()
    assert line.startswith(expected)
    assert " s: /simulator: the simulated camera cannot draw (" in line
    assert "sudo apt-get install libegl1" in line
    session.stop(viewer)
    session.stop(simulator)
    del session.env["PYOPENGL_PLATFORM"]
