"""The contract on ROS 2: ros2_stage.py NAME ... makes checks, and prints their failures by name as a line of JSON."""

from __future__ import annotations

import json
import math
import sys
import time
import traceback
from collections.abc import Callable
from typing import Any

import numpy as np
import rclpy
from rcl_interfaces.srv import DescribeParameters, SetParameters
from rclpy.parameter import Parameter
from tests.ur_nodes.ports.contract import CHECKS
from tests.ur_nodes.ports.stage import Described, GoalClient, Stage, TopicGoalClient

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
    only_live_parameters = False
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

    def set_parameter(self, name: str, value: object) -> str:
        request = SetParameters.Request()
        request.parameters = [Parameter(name.replace("/", "."), value=value).to_parameter_msg()]
        result = self._call(SetParameters, "set_parameters", request).results[0]
        assert result.successful is (result.reason == "")
        return str(result.reason)

    def describe(self, name: str) -> Described:
        request = DescribeParameters.Request()
        request.names = [name.replace("/", ".")]
        found = self._call(DescribeParameters, "describe_parameters", request).descriptors[0]
        limits = (*found.floating_point_range, *found.integer_range)
        low, high = (limits[0].from_value, limits[0].to_value) if limits else (-math.inf, math.inf)
        return Described(found.description, low, high, found.read_only)

    def _call(self, kind: Any, service: str, request: Any) -> Any:
        """Call a service of the node, by another one."""
        other = rclpy.create_node("other")
        try:
            client = other.create_client(kind, f"/contract/{service}")
            assert client.wait_for_service(20.0)
            future = client.call_async(request)
            rclpy.spin_until_future_complete(other, future, timeout_sec=20.0)
            return future.result()
        finally:
            other.destroy_node()

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
