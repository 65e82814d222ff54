"""Stands in for a driver and listens to what the adapter makes of it: a JSON request a line in, a JSON answer out."""

from __future__ import annotations

import threading
import time
from typing import Any

import rospy
from nav_msgs.msg import Odometry
from roslib.message import get_message_class
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Bool
from tests.ur_nodes.ros1_client import run_client
from tf2_msgs.msg import TFMessage


class DriverClient:
    def __init__(self) -> None:
        self.arrived = threading.Condition()
        self.heard: dict[str, list[Any]] = {}
        self.sensor = get_message_class("neato_node/Sensor")  # made for the tests that need it
        self.publishers = {
            "odom": rospy.Publisher("/odom", Odometry, queue_size=10),
            "driver/scan": rospy.Publisher("/driver/scan", LaserScan, queue_size=10),
        }
        if self.sensor:
            self.publishers["sensor"] = rospy.Publisher("/sensor", self.sensor, queue_size=10)

    def listen(self, topics: list[str]) -> None:
        kinds = {"joint_states": JointState, "scan": LaserScan, "tf": TFMessage}
        for topic in topics:
            self.heard[topic] = []
            rospy.Subscriber(f"/{topic}", kinds.get(topic, Bool), self.hear, topic)

    def hear(self, message: Any, topic: str) -> None:
        with self.arrived:
            self.heard[topic].append(message)
            self.arrived.notify_all()

    def send(self, topic: str, until: str, count: int, **values: Any) -> None:
        """Publish on a topic, with stamps 0.05 s apart, until so many messages have come on another one."""
        end, number = time.monotonic() + 60.0, 0
        while len(self.heard[until]) < count:
            assert time.monotonic() < end, f"{len(self.heard[until])} of {count} messages on {until}"
            self.publishers[topic].publish(self.make(topic, 100.0 + 0.05 * number, values))
            number += 1
            with self.arrived:
                self.arrived.wait_for(lambda: len(self.heard[until]) >= count, 0.05)

    def make(self, topic: str, stamp: float, values: dict[str, Any]) -> Any:
        if topic == "sensor":
            return self.sensor(value=True, name=values["name"])
        message: Any = (
            Odometry() if topic == "odom" else LaserScan(ranges=[1.0, 2.0], angle_increment=0.1, range_max=8.0)
        )
        message.header.stamp = rospy.Time.from_sec(stamp)
        message.header.frame_id = "odom" if topic == "odom" else "base_laser_link"
        if topic == "odom":
            message.pose.pose.position.x, message.pose.pose.orientation.w = 3.0, 1.0
            message.twist.twist.linear.x = values["speed"]
        return message

    def wait(self, topic: str, count: int) -> list[Any]:
        """The messages of a topic, once there are so many."""
        with self.arrived:
            assert self.arrived.wait_for(lambda: len(self.heard[topic]) >= count, 60.0), topic
            return [brief(message) for message in self.heard[topic]]


def brief(message: Any) -> Any:
    if isinstance(message, Bool):
        return message.data
    if isinstance(message, TFMessage):
        transform = message.transforms[0]
        return [transform.header.frame_id, transform.child_frame_id, transform.transform.translation.x]
    if isinstance(message, LaserScan):
        return [message.header.frame_id, list(message.ranges)]
    return {
        "stamp": message.header.stamp.to_sec(),
        "names": message.name,
        "angles": list(message.position),
        "speeds": list(message.velocity),
    }


if __name__ == "__main__":
    run_client(DriverClient)
