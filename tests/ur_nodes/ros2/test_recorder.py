"""The recorder on ROS 2: publishers that are best effort, that come later, and that change the type of a topic."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

import pytest
from tests.ros2_session import PYTHON, Ros2Session

from ur.recordings.mcap_file import open_recording
from ur.source.diagnostic import UserError

SOURCE = str(Path(__file__).with_name("changing_source.py"))
RECORDED = {
    ("/loose", "std_msgs/msg/String", ""),
    ("/mixed", "std_msgs/msg/String", "reliable"),
    ("/mixed", "std_msgs/msg/String", "loose"),
    ("/changing", "std_msgs/msg/String", ""),
    ("/changing", "std_msgs/msg/Int32", ""),
}


def recorded(file: Path) -> set[tuple[str, str, str]]:
    """Topic, type and sender of the messages of a file, which may be incomplete."""
    try:
        return {
            (
                each.topic.name,
                each.topic.type_name,
                next((word for word in ("reliable", "loose") if word.encode() in each.data), ""),
            )
            for each in open_recording(file).messages()
        }
    except UserError:
        return set()


@pytest.mark.timeout(90)
def test_publishers_of_each_quality_and_type_are_recorded(session: Ros2Session, tmp_path: Path) -> None:
    folder = tmp_path / "recordings"
    source = subprocess.Popen([PYTHON, SOURCE], env=session.environment)
    try:
        session.start(
            "record", "ur_nodes.recorder.record_node", "_topics:=/loose /mixed /changing", f"_folder:={folder}"
        )
        end = time.monotonic() + 60.0
        while (found := {each for file in folder.glob("*") for each in recorded(file)}) != RECORDED:
            assert time.monotonic() < end, RECORDED - found
            time.sleep(0.3)
    finally:
        source.terminate()
        source.wait(20.0)
