"""`ur replay`: what a recording holds, and wrong words."""

import subprocess
from pathlib import Path

import pytest
from tests.ur_nodes.lock_step.failures import FAILURES, record

from ur.cli.main import main

(EMERGENCY,) = (each for each in FAILURES if each.__name__ == "emergency_stop")


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_VERSION", "0")
        return record(EMERGENCY, tmp_path_factory.mktemp("recorded"))[1]


@pytest.fixture(autouse=True)
def _without_a_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME"):
        monkeypatch.setenv(name, str(tmp_path / name))


def test_recording_is_described_without_a_replay(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["replay", str(recording), "--info"]) == 0
    assert "/move_base" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "expected the file of a recording"),
        (["nothing.mcap"], "no such file, expected a recording"),
        (["FILE", "keyboard_navigate", "base"], "'base' is no argument, expected NAME:=VALUE"),
        (["/etc/passwd"], "/etc/passwd: not an MCAP file that can be read (it does not begin as one)"),
    ],
)
def test_wrong_words_are_refused(
    tmp_path: Path, words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "recorded.mcap").touch()  # is not read
    assert main(["replay", *(f"{tmp_path}/recorded.mcap" if word == "FILE" else word for word in words)]) == 2
    assert message in capsys.readouterr().err


def test_bag_of_ros_1_is_refused_with_the_command_that_converts_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rosbag1 = pytest.importorskip("rosbags.rosbag1", reason="rosbags is not installed: requirements/recordings.lock")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    text = store.types["std_msgs/msg/String"]("hello")
    with rosbag1.Writer(tmp_path / "an old.bag") as writer:
        topic = writer.add_connection("/chatter", "std_msgs/msg/String", typestore=store)
        writer.write(topic, 1_700_000_000_000_000_000, store.serialize_ros1(text, "std_msgs/msg/String"))
    assert main(["replay", str(tmp_path / "an old.bag"), "--info"]) == 2
    error, help = capsys.readouterr().err.splitlines()[:2]
    assert "a bag of ROS 1, expected an MCAP file" in error
    assert subprocess.run(help.strip().removeprefix("help: "), shell=True, check=False).returncode == 0
    assert main(["replay", str(tmp_path / "an old/an old.mcap"), "--info"]) == 0
    assert "/chatter" in capsys.readouterr().out
