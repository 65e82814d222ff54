"""A recording of ROS 1, with its encoding and names, played on ROS 2."""

from pathlib import Path

import pytest
from tests.ros2_session import Ros2Session

mcap = pytest.importorskip("mcap.writer", reason="mcap is not installed: requirements/recordings.lock")
EARS = """
import time, rclpy
from std_msgs.msg import String
rclpy.init()
node, heard = rclpy.create_node("ears"), []
node.create_subscription(String, "/navigate_to_pose/state", lambda message: heard.append(message.data), 10)
end = time.monotonic() + 20.0
while not heard and time.monotonic() < end:
    rclpy.spin_once(node, timeout_sec=0.1)
print(heard[:1])
"""


def record(file: Path) -> None:
    with file.open("wb") as stream:
        writer = mcap.Writer(stream)
        writer.start(profile="ros1")
        schema = writer.register_schema("std_msgs/String", "ros1msg", b"string data\n")
        channel = writer.register_channel("/move_base/state", "ros1", schema)
        for number in range(400):
            at = 1_700_000_000_000_000_000 + 50_000_000 * number
            writer.add_message(channel, at, b"\x05\x00\x00\x00hello", at)
        writer.finish()


@pytest.mark.timeout(90)
def test_recording_of_ros_1_is_heard_by_the_name_and_type_of_ros_2(session: Ros2Session, tmp_path: Path) -> None:
    record(tmp_path / "ros1.mcap")
    session.start("replay", "ur_nodes.replay.replay_node", f"_recording:={tmp_path / 'ros1.mcap'}")
    ears = session.run("-c", EARS, within=60.0)
    assert ears.stdout.strip() == "['hello']", ears.stderr + (tmp_path / "replay.txt").read_text()
