"""The contract on ROS 2: ros2_stage.py NAME ... makes checks, and prints their failures by name as a line of JSON."""

from __future__ import annotations

import json
import sys
import time
import traceback
from collections.abc import Callable

import numpy as np
import rclpy
from tests.ur_nodes.ports.contract import CHECKS
from tests.ur_nodes.ports.stage import GoalClient, Stage, TopicGoalClient

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map
from ur_nodes.ros2.node import RosNode


class Ros2Stage:
    """One node of ROS 2, for both ends."""

    raw_senders_unknown = True
    moments_known = True
    silent_services_hide_failures = True
    keeps_for_all = False
    string_type = "std_msgs/msg/String"
    wire = b"\x00\x01\x00\x00\x06\x00\x00\x00hello\x00"

    def __init__(self) -> None:
        self.node = RosNode("contract")
        self.one: Node = self.node
        self.other: Node = self.node

    def begin(self) -> None:
        self.node.begin()

    def until(self, condition: Callable[[], bool]) -> None:
        end = time.monotonic() + 20.0
        while not condition():
            assert time.monotonic() < end, "waited for 20 s"
            time.sleep(0.005)

    def client(self, action: str) -> GoalClient:
        client = TopicGoalClient(self.one, action, lambda: time.sleep(0.01))
        self.until(client.is_connected)
        return client

    def spoil(self, topic: str) -> None:
        publisher = self.one.publish(topic, Map, Quality.LATCHED)
        publisher.send(Map(0, "map", Grid(np.zeros((1, 1), np.int8), 0.0, Pose2(0.0, 0.0, 0.0))))


def main(names: list[str]) -> None:
    failures: dict[str, str] = {}
    for name in names:
        rclpy.init()
        if problem := _failure(CHECKS[name]):
            failures[name] = problem
        rclpy.try_shutdown()
    sys.stdout.write(json.dumps(failures) + "\n")
    sys.stdout.flush()


def _failure(check: Callable[[Stage], None]) -> str:
    stage = Ros2Stage()
    try:
        check(stage)
    except Exception:
        return traceback.format_exc()
    finally:
        stage.node.close()
    return ""


if __name__ == "__main__":
    main(sys.argv[1:])
