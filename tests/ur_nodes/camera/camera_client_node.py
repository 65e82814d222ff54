"""Subscribes to cameras and calls their services: a JSON request a line in, an answer a line out."""

from __future__ import annotations

import hashlib
import threading
from typing import Any

import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from sensor_msgs.srv import SetCameraInfo
from std_srvs.srv import Empty
from tests.json_client import answer_requests, claim_output

KINDS = {"compressed": CompressedImage, "image": Image, "camera_info": CameraInfo}


class Client:
    def __init__(self) -> None:
        self.arrived = threading.Condition()
        self.messages: dict[str, list[Any]] = {}
        self.subscribers: dict[str, Any] = {}

    def do_listen(self, topic: str) -> None:
        kind = KINDS[topic.rpartition("/")[2]]
        self.subscribers[topic] = rospy.Subscriber(topic, kind, self.hear, topic, buff_size=1 << 24)
        self.messages[topic] = []

    def do_leave(self, topic: str) -> None:
        self.subscribers.pop(topic).unregister()

    def hear(self, message: Any, topic: str) -> None:
        with self.arrived:
            self.messages[topic].append(message)
            self.arrived.notify_all()

    def do_wait(self, topic: str, count: int) -> dict[str, Any]:
        """The newest message, after so many new ones."""
        with self.arrived:
            total = len(self.messages[topic]) + count
            assert self.arrived.wait_for(lambda: len(self.messages[topic]) >= total, 60.0), f"nothing on {topic}"
            return brief(self.messages[topic][-1])

    def do_set(self, service: str, width: int, focal: float) -> list[Any]:
        rospy.wait_for_service(service, 60.0)
        info = CameraInfo(width=width, height=480, distortion_model="plumb_bob", D=[0.0] * 5)
        info.K = [focal, 0.0, 319.5, 0.0, focal, 239.5, 0.0, 0.0, 1.0]
        info.R, info.P = [1.0, 0, 0, 0, 1, 0, 0, 0, 1], [focal, 0.0, 319.5, 0, 0, focal, 239.5, 0, 0, 0, 1, 0]
        answer = rospy.ServiceProxy(service, SetCameraInfo)(info)
        return [answer.success, answer.status_message]

    def do_call(self, service: str) -> None:
        rospy.wait_for_service(service, 60.0)
        rospy.ServiceProxy(service, Empty)()


def brief(message: Any) -> dict[str, Any]:
    found = {"frame": message.header.frame_id, "age": (rospy.Time.now() - message.header.stamp).to_sec()}
    if isinstance(message, CameraInfo):
        return {**found, "size": [message.width, message.height], "focal": message.K[0]}
    if isinstance(message, Image):
        return {**found, "size": [message.width, message.height], "encoding": message.encoding}
    return {**found, "format": message.format, "hash": hashlib.sha256(message.data).hexdigest()}


def main() -> None:
    answers = claim_output()
    rospy.init_node("camera_client", anonymous=True, disable_signals=True)
    answer_requests(answers, Client(), "do_")


if __name__ == "__main__":
    main()
