"""A node of one of two computers: publishes what a robot or a laptop does, and prints when what the other sent arrives.

Each line is a list in JSON: topic, when it was sent, when it arrived, both on the clock that all processes of one
computer share (time.monotonic), and the number of threads of this process.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from typing import Any

import rospy
from actionlib_msgs.msg import GoalStatusArray
from geometry_msgs.msg import PoseStamped, TransformStamped, Twist
from nav_msgs.msg import OccupancyGrid
from tf2_msgs.msg import TFMessage

from ur_nodes.ros1.run import run_node

LATCHED = ("map", "goal")


def sent_at(message: Any) -> float:
    if isinstance(message, TFMessage):
        return float(message.transforms[0].header.stamp.to_sec())
    if isinstance(message, Twist):
        return float(message.linear.x)
    return float(message.header.stamp.to_sec())


def note(message: Any, topic: str) -> None:
    line = [topic, sent_at(message), time.monotonic(), threading.active_count()]
    sys.stdout.write(json.dumps(line) + "\n")
    sys.stdout.flush()


def now() -> rospy.Time:
    return rospy.Time.from_sec(time.monotonic())


def make_transform() -> TFMessage:
    transform = TransformStamped()
    transform.header.stamp = now()
    transform.header.frame_id, transform.child_frame_id = "odom", "base_footprint"
    transform.transform.rotation.w = 1.0
    return TFMessage([transform])


def make_status() -> GoalStatusArray:
    status = GoalStatusArray()
    status.header.stamp = now()
    return status


def make_twist() -> Twist:
    twist = Twist()
    twist.linear.x = time.monotonic()
    return twist


def repeat(rate: float, publisher: Any, make: Any) -> None:
    def run() -> None:
        while not rospy.is_shutdown():
            try:
                publisher.publish(make())
            except rospy.ROSException:
                return
            time.sleep(1.0 / rate)

    threading.Thread(target=run, daemon=True).start()


def start_robot() -> None:
    rospy.Subscriber("key_vel", Twist, note, "key_vel", queue_size=10)
    rospy.Subscriber("goal", PoseStamped, note, "goal", queue_size=1)
    repeat(50.0, rospy.Publisher("tf", TFMessage, queue_size=100), make_transform)
    repeat(5.0, rospy.Publisher("status", GoalStatusArray, queue_size=10), make_status)
    grid = OccupancyGrid()
    grid.header.stamp = now()
    grid.info.width = grid.info.height = 400
    grid.data = [0] * (400 * 400)
    publisher = rospy.Publisher("map", OccupancyGrid, latch=True, queue_size=1)
    publisher.publish(grid)
    globals()["kept"] = publisher


def start_laptop() -> None:
    for topic, kind in (("tf", TFMessage), ("status", GoalStatusArray), ("map", OccupancyGrid)):
        rospy.Subscriber(topic, kind, note, topic, queue_size=100, tcp_nodelay=True)
    repeat(20.0, rospy.Publisher("key_vel", Twist, queue_size=1), make_twist)
    goal = PoseStamped()
    goal.header.stamp = now()
    publisher = rospy.Publisher("goal", PoseStamped, latch=True, queue_size=1)
    publisher.publish(goal)
    globals()["kept"] = publisher


def main(side: str, *options: str) -> int:
    start = {"robot": start_robot, "laptop": start_laptop}[side]
    if "--plain" not in options:
        return run_node(side, start)
    rospy.init_node(side)
    start()
    rospy.spin()
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
