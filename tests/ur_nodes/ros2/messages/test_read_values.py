"""Messages that are read without rclpy, beside what rclpy makes of them."""

from __future__ import annotations

from tests.ros2_session import Ros2Session

PROGRAM = """
import numpy as np
from rclpy.serialization import serialize_message

from ur_nodes.codecs import find_codec
from ur_nodes.codecs.bare import READERS, Reader
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.values import Odometry, StampedTwist, Twist

twist = Twist(0.5, -1.0, 0.25, 1.0, 2.0, 3.0)
matrix = np.arange(9.0).reshape(3, 3)
values = [twist, *(StampedTwist(3, "i" * length, twist) for length in range(9))]
values += [
    Odometry(8, "o" * length, "b" * other, Pose2(1.0, 2.0, 0.5), twist, matrix, 2.0 * matrix)
    for length in range(5) for other in range(5)
]
for value in values:
    kind = type(value)
    codec = find_codec(kind)
    message = codec.message_class()
    codec.fill(message, value)
    data = bytes(serialize_message(message))
    assert repr(READERS[kind](Reader(data))) == repr(codec.value_of(message)), value
    for end in range(len(data)):
        try:
            READERS[kind](Reader(data[:end]))
        except ValueError:
            continue
        raise AssertionError(end)
twisted = b"\\0\\0\\0\\0" + np.arange(6.0).astype(">f8").tobytes()
assert READERS[Twist](Reader(twisted)) == Twist(0.0, 5.0, 1.0, 2.0, 3.0, 4.0)
print("equal")
"""


def test_values_are_those_that_rclpy_reads_and_what_is_cut_off_is_refused(session: Ros2Session) -> None:
    done = session.run("-c", PROGRAM, within=60.0)
    assert done.stdout.split() == ["equal"], done.stderr
