"""Messages that wait for a node's next timer."""

from __future__ import annotations

from tests.ros2_session import Ros2Session

PROGRAM = """
import os
import threading
import rclpy
from geometry_msgs.msg import Twist as Message
import ur_nodes.loop
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Twist
from ur_nodes.ros2.node import RosNode

ur_nodes.loop._LONGEST_WAIT = 60.0
rclpy.init()
node, events, some, ended = RosNode("holder"), [], threading.Semaphore(0), threading.Event()
seen = RosNode("witness")
seen.subscribe("cmd_vel", Twist, lambda twist: some.release(), Quality.EVERY)
node.subscribe("cmd_vel", Twist, lambda twist: events.append(twist.forward), Quality.EVERY)
for each in (node, seen):
    each.begin()
publisher = rclpy.create_node("other").create_publisher(Message, "cmd_vel", 10)
while publisher.get_subscription_count() < 2 or not events:
    publisher.publish(Message())
    some.acquire(timeout=0.1)

def start():
    events.clear()
    node.hold_messages(True)
    node.after(3.0, lambda: (events.append("timer"), ended.set()), steady=True)

while some.acquire(timeout=0.5):
    pass
for call in (start, lambda: None, lambda: None):  # after these no earlier wake of its thread is left
    begun = threading.Event()
    node.post(lambda: (call(), begun.set()))
    begun.wait()
for forward in (1.0, 2.0, 3.0):
    message = Message()
    message.linear.x = forward
    publisher.publish(message)
    some.acquire()
held = list(events)
ended.wait()
print(held, events, flush=True)
os._exit(0)
"""


def test_held_messages_are_received_in_order_before_the_timer_that_they_wait_for(session: Ros2Session) -> None:
    done = session.run("-c", PROGRAM, within=60.0)
    assert done.stdout == "[] [1.0, 2.0, 3.0, 'timer']\n", done.stderr
