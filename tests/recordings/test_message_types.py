"""Types of messages in recordings: ROS 1 as ROS 2 and back, and definitions that cannot be read."""

import struct
from dataclasses import replace
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from ur.recordings.mcap_channels import register_channel
from ur.recordings.mcap_file import RecordingTopic, open_recording
from ur.recordings.message_types import MessageTypes
from ur.report.archive import copy_recording
from ur.report.secrets import SecretFilter

STORE = get_typestore(Stores.ROS1_NOETIC)
SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND


def definition(type_name: str) -> str:
    return STORE.generate_msgdef(type_name.replace("/", "/msg/"), ros_version=1)[0]


def text(value: bytes) -> bytes:
    return struct.pack("<I", len(value)) + value


def header(frame: bytes) -> bytes:
    return struct.pack("<III", 0, 1, 2) + text(frame)


def transform(parent: bytes, child: bytes, x: float, y: float, turn: tuple[float, float]) -> bytes:
    numbers = struct.pack("<7d", x, y, 0.0, 0.0, 0.0, *turn)
    return struct.pack("<I", 1) + header(parent) + text(child) + numbers


def grid() -> bytes:
    info = struct.pack("<IIfII", 0, 0, 0.5, 3, 2) + struct.pack("<7d", -1.0, -2.0, 0, 0, 0, 0, 1)
    return header(b"map") + info + struct.pack("<I", 6) + bytes([100, 0, 0, 0, 0, 255])


PART = "geometry_msgs/TransformStamped"
SCHEMA = f"{PART}[] transforms\n{'=' * 80}\nMSG: {PART}\n{definition(PART)}"
TF = RecordingTopic("/tf", "tf2_msgs/TFMessage", SCHEMA, "ros1")
MAP = RecordingTopic("/map", "nav_msgs/OccupancyGrid", definition("nav_msgs/OccupancyGrid"), "ros1")
QUARTER = (0.7071067811865476, 0.7071067811865476)


def write(path: Path, messages: list[tuple[RecordingTopic, bytes]]) -> Path:
    """A message each second."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros1", library="tests")
        for number, (each, data) in enumerate(messages):
            channel = register_channel(writer, each.name, each.type_name, each.schema, "/robot")
            writer.add_message(channel, BEGIN + number * SECOND, data, BEGIN)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


DRIVE = [
    (MAP, grid()),
    (TF, transform(b"map", b"odom", 1.0, 2.0, QUARTER)),
    (TF, transform(b"odom", b"base_footprint", 3.0, 0.0, (0.0, 1.0))),
    (TF, transform(b"odom", b"base_footprint", 4.0, 0.0, QUARTER)),
]


def test_messages_are_converted_to_ros2_and_back() -> None:
    types = MessageTypes()
    made = types.convert_topic(TF, "ros2")
    assert (made.type_name, made.encoding) == ("tf2_msgs/msg/TFMessage", "cdr")
    assert "builtin_interfaces/Time stamp" in made.schema
    data = DRIVE[1][1]
    converted = types.convert(TF, made, data)
    assert types.decode(made, converted).transforms[0].child_frame_id == "odom"
    back = types.convert_topic(made, "ros1")
    assert back.type_name == "tf2_msgs/TFMessage"
    assert types.convert(made, back, converted) == data
    assert types.convert_topic(made, "ros2") is made


def test_types_of_one_name_and_two_definitions_are_told_apart() -> None:
    types = MessageTypes()
    for schema, data, value in (("int32 data", b"\1\0\0\0", 1), ("string data", text(b"one"), "one")):
        kind = RecordingTopic("/a", "some_msgs/Thing", schema, "ros1")
        made = types.convert_topic(kind, "ros2")
        assert types.decode(made, types.convert(kind, made, data)).data == value


def test_what_cannot_be_read_is_refused_or_left_as_it_is() -> None:
    types = MessageTypes()
    odd = RecordingTopic("/odd", "some_msgs/Odd", "not a definition!", "ros1")
    assert types.convert_topic(odd, "ros2") is odd
    with pytest.raises(ValueError, match="cannot be read"):
        types.decode(odd, b"")
    made = types.convert_topic(TF, "ros2")
    for data in (b"", b"\xff" * 40):
        with pytest.raises(ValueError, match="/tf: "):
            types.convert(TF, made, data)
    plain = replace(TF, encoding="text")
    assert types.convert_topic(plain, "ros2") is plain


def test_report_of_ros1_is_opened_by_rosbags_and_has_right_checksums(tmp_path: Path) -> None:
    copy = tmp_path / "copy.mcap"
    copy_recording(write(tmp_path / "one.mcap", DRIVE), copy, SecretFilter())
    with AnyReader([copy]) as reader:
        seen = [(each.topic, reader.deserialize(data, each.msgtype)) for each, _, data in reader.messages()]
    assert [name for name, _ in seen] == ["/map", "/tf", "/tf", "/tf"]
    assert seen[1][1].transforms[0].header.stamp.nanosec == 2  # type: ignore[attr-defined]
    with copy.open("rb") as file:
        checked = make_reader(file, validate_crcs=True)
        assert checked.get_header().profile == "ros2"
        assert len(list(checked.iter_messages())) == 4
    assert open_recording(copy).topics["/tf"].sender == "/robot"
