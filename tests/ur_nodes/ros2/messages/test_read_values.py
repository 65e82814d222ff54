"""Messages that are read without rclpy, beside what rclpy makes of them."""

from __future__ import annotations

from tests.ros2_session import Ros2Session

PROGRAM = """
import numpy as np
from rclpy.serialization import deserialize_message, serialize_message

from ur_nodes.codecs import find_codec
from ur_nodes.codecs.bare import READERS, WRITERS, Reader
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.values import Odometry, Scan, StampedTwist, Time, Twist

twist = Twist(0.5, -1.0, 0.25, 1.0, 2.0, 3.0)
matrix = np.arange(9.0).reshape(3, 3)
values = [twist, Time(3_000_000_007), *(StampedTwist(3, "i" * length, twist) for length in range(9))]
values += [
    Odometry(8, "o" * length, "b" * other, Pose2(1.0, 2.0, 0.5), twist, matrix, 2.0 * matrix)
    for length in range(5) for other in range(5)
]
beams = np.array([1.0, np.inf, np.nan, 0.1], np.float32)
values += [
    Scan(7, "l" * length, -1.5, 0.25, 0.1, 12.0, beams[:count], beams[:other], 0.1, 1.5, 0.01)
    for length in range(5) for count in range(4) for other in (0, count)
]
for value in values:
    kind = type(value)
    codec = find_codec(kind)
    message = codec.message_class()
    codec.fill(message, value)
    data = bytes(serialize_message(message))
    assert kind not in WRITERS or WRITERS[kind](value) == data, value
    if kind not in READERS:
        continue
    received = codec.value_of(deserialize_message(data, codec.message_class))
    assert repr(READERS[kind](Reader(data))) == repr(received), value
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


HOSTILE = """
import os
import threading
import rclpy
from geometry_msgs.msg import Twist as Message
from ur_nodes.ports.values import Twist
from ur_nodes.ros2.node import RosNode

rclpy.init()
node, values, arrived, failed = RosNode("victim"), [], threading.Event(), threading.Event()
node.subscribe("cmd_vel", Twist, lambda value: (values.append(value.forward), arrived.set()))
node.begin(failed.set)
publisher = rclpy.create_node("other").create_publisher(Message, "cmd_vel", 10)
for data in (b"\\0\\1\\0\\0\\0", b"\\0\\2\\0\\0", b"", b"\\xff\\xff\\0\\0" + bytes(48)):
    message = Message()
    arrived.clear()
    while not arrived.wait(0.1):
        publisher.publish(data)
        publisher.publish(message)
print(failed.is_set(), set(values), flush=True)
os._exit(0)
"""


def test_bytes_of_another_kind_are_refused_and_the_next_message_arrives(session: Ros2Session) -> None:
    done = session.run("-c", HOSTILE, within=60.0)
    assert done.stdout == "False {0.0}\n", done.stderr
