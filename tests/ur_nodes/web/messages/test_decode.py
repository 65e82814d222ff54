"""Definitions and messages from the network: read to the bounds, and refused in a line where they are malformed."""

from __future__ import annotations

import math
import random
import struct
from typing import Any

import pytest

from ur_nodes.web.messages.decode import BadMessageError, Bounds, Cut, decode, render
from ur_nodes.web.messages.definition import BadDefinitionError, read_definition

POINT = "float64 x\nfloat64 y\n"
TEXT = f"""# a comment
int32 LIMIT = 5
string NAME=a "b" # not a comment
Header header
Point[] points
geometry_msgs/Point[2] two  # fixed
string[] names
bool good
int64 large
float32 level
uint8[] data
duration left
{"=" * 80}
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
{"=" * 80}
MSG: geometry_msgs/Point
{POINT}{"=" * 80}
MSG: demo/Point
{POINT}"""


def text(value: str) -> bytes:
    data = value.encode()
    return struct.pack("<I", len(data)) + data


def message(points: int = 1, names: tuple[str, ...] = ("a",), level: float = 0.1, data: bytes = b"\x01") -> bytes:
    return b"".join(
        [
            struct.pack("<III", 7, 10, 500_000_000) + text("map"),
            struct.pack("<I", points) + struct.pack("<dd", 1.0, 2.0) * points,
            struct.pack("<dddd", 1.0, 2.0, 3.0, math.nan),
            struct.pack("<I", len(names)) + b"".join(map(text, names)),
            struct.pack("<?qf", True, 2**60, level),
            struct.pack("<I", len(data)) + data,
            struct.pack("<ii", -1, 0),
        ]
    )


def read(data: bytes, bounds: Bounds = Bounds()) -> dict[str, Any]:  # noqa: B008 - frozen
    return decode(read_definition("demo/Thing", TEXT), data, bounds)


def test_message_is_decoded_by_its_definition_alone() -> None:
    assert read(message()) == {
        "header": {"seq": 7, "stamp": 10.5, "frame_id": "map"},
        "points": [{"x": 1.0, "y": 2.0}],
        "two": [{"x": 1.0, "y": 2.0}, {"x": 3.0, "y": "nan"}],
        "names": ["a"],
        "good": True,
        "large": str(2**60),
        "level": 0.1,
        "data": [1],
        "left": -1.0,
    }


def test_long_arrays_and_texts_are_cut_and_what_follows_is_right() -> None:
    found = read(message(1000, ("x" * 50,) * 100, data=bytes(5000)), Bounds(items=3, letters=10))
    assert found["points"] == Cut([{"x": 1.0, "y": 2.0}] * 3, 1000)
    assert found["names"] == Cut(["x" * 10 + "..."] * 3, 100)
    assert found["data"] == Cut([0, 0, 0], 5000)
    assert found["left"] == -1.0


def test_values_are_bounded_in_all() -> None:
    found = read(message(50, ("x",) * 50), Bounds(values=20))
    assert len(found["points"].items) + len(found["names"].items) <= 20


@pytest.mark.parametrize("length", [0, 5, 30, len(message()) - 1])
def test_message_that_ends_early_is_refused(length: int) -> None:
    with pytest.raises(BadMessageError, match=r"ends within|bytes are left"):
        read(message()[:length])


def test_lengths_that_no_message_has_are_refused_at_once() -> None:
    most = struct.pack("<I", 2**32 - 1)
    header = struct.pack("<III", 7, 10, 0) + text("map")
    with pytest.raises(BadMessageError, match="4294967295 elements"):
        read(header + most)
    empties = read_definition("a/B", f"C[] many\n{'=' * 20}\nMSG: a/C\n")
    assert decode(empties, most) == {"many": Cut([{}] * 64, 2**32 - 1)}


def test_arrays_of_nothing_within_one_another_end() -> None:
    kinds = [f"K{level + 1}[100000] many\n" for level in range(9)] + [""]
    parts = [f"{'=' * 20}\nMSG: a/K{level}\n{each}" for level, each in enumerate(kinds)]
    definition = read_definition("a/Root", "K0 first\n" + "".join(parts))
    assert decode(definition, b"", Bounds(values=500)).keys() == {"first"}


@pytest.mark.parametrize(
    ("definition", "problem"),
    [
        ("Missing x\n", "not in the definition"),
        ("int32 x y\n", "TYPE NAME"),
        ("int32 __import__('os')\n", "TYPE NAME"),
        ("Root again\n", "within one another"),
        ("int32[99999999] x\n", "array of 99999999"),
        ("int32 x\n" * 500, "at most 400 fields"),
        (f"int32 x\n{'=' * 20}\nint32 y\n", "without the line"),
        ("x" * 300_000, "at most 200000"),
    ],
)
def test_definition_that_is_none_is_refused(definition: str, problem: str) -> None:
    with pytest.raises(BadDefinitionError, match=problem):
        read_definition("a/Root", definition)


def test_types_that_hold_one_another_many_times_are_read_at_once() -> None:
    layers = [
        f"{'=' * 20}\nMSG: a/L{level}x{each}\n" + "".join(f"L{level + 1}x{k} f{k}\n" for k in range(10) if level < 8)
        for level in range(9)
        for each in range(10)
    ]
    definition = read_definition("a/Root", "L0x0 first\n" + "".join(layers))
    with pytest.raises(BadMessageError, match="more than"):
        decode(definition, b"")


def try_to_read(data: bytes) -> list[str]:
    """The lines of a message, or the one that says why it is none."""
    try:
        return render(read(data))
    except BadMessageError as problem:
        return str(problem).split("\n")


def test_random_bytes_are_decoded_or_refused() -> None:
    chance = random.Random(3)
    found = [try_to_read(chance.randbytes(chance.randrange(300))) for _ in range(500)]
    assert max(map(len, found)) < 500
    assert min(map(len, found)) == 1


def test_lines_hold_nothing_that_acts_on_a_screen_and_are_bounded() -> None:
    lines = render(read(message(names=("\x1b[2J<b>", "n" * 2000), level=math.inf)))
    assert 'names: ["\\x1b[2J<b>", "nnn' in "\n".join(lines)
    assert "level: inf" in lines
    assert "good: true" in lines
    assert max(map(len, lines)) <= 300
    assert render(read(message(60)), most=5)[-1] == "..."
    assert "points:  # the first 2 of 60" in render(read(message(60), Bounds(items=2)))


@pytest.mark.ros
def test_messages_of_ros_are_decoded_as_genpy_does() -> None:
    pytest.importorskip("rospy", reason="ROS is not installed")
    import io

    from nav_msgs.msg import Odometry

    sent = Odometry()
    sent.header.frame_id = "odom"
    sent.pose.pose.position.x = 1.25
    sent.twist.covariance[35] = 2.5
    buffer = io.BytesIO()
    sent.serialize(buffer)
    found = decode(read_definition("nav_msgs/Odometry", Odometry._full_text), buffer.getvalue())
    assert found["header"]["frame_id"] == "odom"
    assert found["pose"]["pose"]["position"] == {"x": 1.25, "y": 0.0, "z": 0.0}
    assert found["twist"]["covariance"][35] == 2.5
