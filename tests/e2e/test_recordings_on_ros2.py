"""`ur record` and `ur replay` on ROS 2, with the wheels, which have no tf2_msgs; `rosbags` reads the file, too."""

import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT, UrShell, end
from tests.e2e.matrix_ros2 import Ros2Ears, ros2_environment
from tests.e2e.matrix_table import Topic
from tests.ros2_session import PYTHON, free_domain

pytestmark = [
    pytest.mark.timeout(600),
    pytest.mark.skipif(not PYTHON.exists(), reason="no wheels of ROS 2 for this processor"),
]
rosbags = pytest.importorskip("rosbags.highlevel", reason="rosbags is not installed: requirements/recordings.lock")
TOPICS = ("/odom", "/scan", "/tf")


@pytest.fixture
def shell(tmp_path: Path) -> Iterator[UrShell]:
    made = UrShell(tmp_path)
    made.environment |= {"ROS_DOMAIN_ID": free_domain(), "XDG_RUNTIME_DIR": str(tmp_path / "run")}
    assert made.ur("use", "sim", "--ros", "2").returncode == 0
    yield made
    assert made.ur("stop", "--all").returncode == 0


def wait(condition: Callable[[], bool], what: str, seconds: float = 150.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, what
        time.sleep(0.1)


def hears_all(ears: Ros2Ears) -> bool:
    ears.listen(0.2)
    return min(len(each.times) for each in ears.heard.values()) > 5


def record(shell: UrShell, folder: Path) -> Path:
    started = shell.ur("run", "robot_base", "--detach", "--wait", "--timeout-ready", "200")
    assert started.returncode == 0, started.stderr
    recording = shell.ur("record", *TOPICS, "--to", str(folder), "--detach")
    assert recording.returncode == 0, recording.stderr
    wait(lambda: any(each.stat().st_size > 100_000 for each in folder.glob("*")), "nothing is recorded")
    assert shell.ur("stop", "--all").returncode == 0
    (file,) = folder.iterdir()
    assert file.suffix == ".mcap"
    return file


def test_robot_is_recorded_and_played_again(shell: UrShell, tmp_path: Path) -> None:
    file = record(shell, tmp_path / "recordings")
    with rosbags.AnyReader([file]) as reader:
        frames = set()
        for connection, _time, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            if connection.topic == "/tf":
                frames |= {each.child_frame_id for each in message.transforms}
        assert {each.topic for each in reader.connections} == set(TOPICS)
    assert "base_footprint" in frames

    environment = shell.environment | ros2_environment(tmp_path, shell.environment["ROS_DOMAIN_ID"])
    ears = Ros2Ears(environment, [Topic("/odom"), Topic("/scan")])
    nowhere = subprocess.DEVNULL
    command = [str(ROOT / "ur"), "replay", str(file)]
    replay = subprocess.Popen(command, env=shell.environment, stdin=nowhere, stdout=nowhere, stderr=nowhere, text=True)
    try:
        wait(lambda: hears_all(ears), "no messages")
        assert "base_footprint" in ears.frames
    finally:
        end(replay)
        ears.close()
