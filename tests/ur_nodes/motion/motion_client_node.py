"""Talks to a robot behind a mux for the tests: a JSON request a line in, a JSON answer a line out."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import String
from std_srvs.srv import Trigger
from tests.json_client import answer_requests, claim_output, wait_until


class MotionClient:
    def __init__(self) -> None:
        self.active: list[str] = []
        self.commands: list[tuple[float, float]] = []
        self.truth = (0.0, 0.0, 0.0)
        self.publishers = {topic: rospy.Publisher(topic, Twist, queue_size=1) for topic in ("key_vel", "nav_vel")}
        rospy.Subscriber("cmd_vel_mux/active", String, lambda message: self.active.append(message.data))
        rospy.Subscriber("cmd_vel", Twist, lambda m: self.commands.append((m.linear.x, m.angular.z)), queue_size=100)
        rospy.Subscriber("base_pose_ground_truth", Odometry, self.on_truth)
        self.driving: threading.Event | None = None

    def on_truth(self, message: Any) -> None:
        twist = message.twist.twist
        self.truth = (message.pose.pose.position.x, twist.linear.x, twist.angular.z)

    def ready(self, seconds: float) -> str:
        self.wait(lambda: bool(self.active) and self.truth[0] > 1.0, seconds)
        self.wait(lambda: all(each.get_num_connections() for each in self.publishers.values()), seconds)
        return self.active[-1]

    def drive(self, topic: str, velocity: list[float], rate: float = 30.0) -> None:
        """Publish until told otherwise."""
        self.rest()
        ended = self.driving = threading.Event()
        message = Twist()
        message.linear.x, message.angular.z = velocity

        def publish() -> None:
            while not ended.wait(1.0 / rate):
                self.publishers[topic].publish(message)

        threading.Thread(target=publish, daemon=True).start()

    def rest(self) -> None:
        if self.driving:
            self.driving.set()

    def moves(self, seconds: float, speed: float = 0.2) -> float:
        """Once it moves that fast."""
        self.wait(lambda: abs(self.truth[1]) >= speed, seconds)
        return self.truth[1]

    def stands(self, seconds: float) -> float:
        """Once it stands and the mux has nothing more to say; where."""
        self.wait(lambda: abs(self.truth[1]) < 0.005 and self.active[-1] == "idle", seconds)
        count = -1
        while count != len(self.commands):
            count = len(self.commands)
            time.sleep(0.15)
        return self.truth[0]

    def call(self, service: str) -> str:
        rospy.wait_for_service(service, 60.0)
        answer = rospy.ServiceProxy(service, Trigger)()
        assert answer.success
        return str(answer.message)

    def hears(self, velocity: list[float], seconds: float) -> list[float]:
        """Wait for such a velocity on `cmd_vel`."""
        self.wait(lambda: tuple(velocity) in self.commands, seconds)
        return velocity

    def forget(self) -> None:
        """What a mux told before it died."""
        self.active = []

    def is_active(self, name: str, seconds: float) -> str:
        self.wait(lambda: self.active[-1] == name, seconds)
        return name

    def history(self) -> dict[str, Any]:
        """Who drove and what was commanded since the last time."""
        told = {"active": self.active[:], "commands": take(self.commands)}
        del self.active[: len(told["active"]) - 1]
        return told

    def wait(self, condition: Callable[[], bool], seconds: float) -> None:
        try:
            wait_until(condition, seconds, "a state of the robot", pause=0.005)
        except TimeoutError as problem:
            raise TimeoutError(f"{problem}: {self.active[-5:]}, {self.truth}") from None


def take(messages: list[Any]) -> list[Any]:
    """What is there; more may come meanwhile."""
    taken = messages[:]
    del messages[: len(taken)]
    return taken


def main() -> None:
    answers = claim_output()
    rospy.init_node("motion_client")
    answer_requests(answers, MotionClient())


if __name__ == "__main__":
    main()
