"""Talks to a simulator for the tests: a JSON request a line in, a JSON answer a line out."""

from __future__ import annotations

import threading
from typing import Any

import rospy
from nav_msgs.srv import SetMap, SetMapRequest
from std_srvs.srv import Empty, SetBool, Trigger
from tests.ur_nodes.ros1_client import run_client


class SimulatorClient:
    def __init__(self) -> None:
        self.arrived = threading.Condition()
        self.counts: dict[str, int] = {}
        self.subscribers: list[rospy.Subscriber] = []

    def collect(self, topics: list[str], count: int, seconds: float) -> None:
        """Listen from now on, until so many messages have arrived on each topic."""
        with self.arrived:
            for topic in topics:
                self.counts[topic] = 0
                self.subscribers.append(rospy.Subscriber(topic, rospy.AnyMsg, self.hear, topic))
            full = self.arrived.wait_for(lambda: all(self.counts[topic] >= count for topic in topics), seconds)
            assert full, f"{self.counts}, expected {count} each"

    def hear(self, _message: Any, topic: str) -> None:
        with self.arrived:
            self.counts[topic] += 1
            self.arrived.notify_all()

    def call(self, service: str, **values: Any) -> Any:
        kinds = {"pause": SetBool, "step": Trigger, "reset": Empty, "place": SetMap}
        name = f"/simulator/{service}"
        rospy.wait_for_service(name, 60.0)
        proxy = rospy.ServiceProxy(name, kinds[service])
        if service == "place":
            request = SetMapRequest()
            request.initial_pose.header.frame_id = "map"
            place = request.initial_pose.pose.pose
            place.position.x, place.position.y, place.orientation.w = values["x"], values["y"], 1.0
            return getattr(proxy(request), "success", None)
        answer = proxy(*values.values())
        return [getattr(answer, "success", None), getattr(answer, "message", None)]


if __name__ == "__main__":
    run_client(SimulatorClient)
