"""Messages that arrive while a node is busy, and a middleware that does not tell of them."""

from __future__ import annotations

import pytest
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
    qos_profile = SimpleNamespace(history=None, depth=1)

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


MANY = """
import threading
import rclpy
from geometry_msgs.msg import Twist as Message
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Twist
from ur_nodes.ros2.node import RosNode

rclpy.init()
node, got, all_there = RosNode("holder"), [], threading.Event()

def take(twist):
    got.append(twist.forward)
    if got[-1] == 79.0:
        all_there.set()

node.subscribe("cmd_vel", Twist, take, Quality.LOSSLESS)
node.begin()
publisher = rclpy.create_node("other").create_publisher(Message, "cmd_vel", rclpy.qos.QoSProfile(history=2, depth=0))
while not got:
    publisher.publish(Message())
    all_there.wait(0.05)
busy, done = threading.Event(), threading.Event()
node.post(lambda: (node.hold_messages(HOLDS), node.after(9.0, all_there.set), busy.set(), done.wait()))
busy.wait()
got.clear()
for number in range(80):
    message = Message()
    message.linear.x = float(number)
    publisher.publish(message)
done.set()
all_there.wait()
print(got == [float(number) for number in range(80)])
node.close()
"""


@pytest.mark.parametrize("holds", [False, True])
def test_messages_that_waited_for_a_busy_node_are_all_received(session: Ros2Session, holds: bool) -> None:
    done = session.run("-c", MANY.replace("HOLDS", str(holds)), within=60.0)
    assert done.stdout == "True\n", done.stderr
