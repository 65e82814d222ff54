"""Messages that arrive while a node is busy, and a middleware that does not tell of them."""

from __future__ import annotations

from tests.ros2_session import Ros2Session

BUSY = """
import threading, time
import rclpy
from ur_nodes.geometry.pose import Pose3
from ur_nodes.ports.values import Transform
from ur_nodes.ros2.node import RosNode
from ur_nodes.ros2.services import TransformTopics

rclpy.init()
node, sending = RosNode("listening"), rclpy.create_node("sending")
tree, topics = node.transforms, TransformTopics(sending)
send = lambda number: topics.send((Transform(number * 10**7, "odom", "base", Pose3(number**2, 0, 0, 0, 0, 0, 1)),))
node.begin()
while tree.find("odom", "base") is None:
    send(100)
    time.sleep(0.01)
busy, done = threading.Event(), threading.Event()
node.post(lambda: (busy.set(), done.wait()))
busy.wait()
for number in range(101, 500):
    send(number)
done.set()
while tree.find("odom", "base").x < 499**2:
    time.sleep(0.01)
print([tree.pose("odom", "base", number / 100).x for number in (150, 300, 498)])
node.close()
"""
SILENT = """
from types import SimpleNamespace
from ur.source.diagnostic import UserError
from ur_nodes.ros2.reception import Reception

class Unknown:
    handle = SimpleNamespace(pointer=0)
    callback = print

try:
    Reception().add_entity(Unknown())
except UserError as problem:
    print(problem)
"""


def test_transforms_that_arrive_during_a_callback_of_seconds_are_all_known_afterwards(session: Ros2Session) -> None:
    done = session.run("-c", BUSY, within=60.0)
    assert done.stdout.strip() == "[22500.0, 90000.0, 248004.0]", done.stderr


def test_middleware_that_does_not_tell_when_messages_arrive_is_named(session: Ros2Session) -> None:
    done = session.run("-c", SILENT, within=60.0)
    assert done.stdout.startswith("this middleware does not tell when messages arrive, expected"), done.stderr
