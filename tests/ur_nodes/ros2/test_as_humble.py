"""Nodes on an rclpy that has no more than Humble's, of the wheels: Humble itself cannot be installed here."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.ros2_session import Ros2Session
from tests.ur_nodes.ports.contract import CHECKS

AS_HUMBLE = Path(__file__).with_name("as_humble.py")
NEEDS_NUMBERS = {"publishers_of_a_topic_are_told_apart_and_what_they_send_has_its_moment"}  # docs/reference/ros2.md

WITHOUT_HASHES = """
import sys
import rclpy.node
from ur.source.diagnostic import UserError
from ur_nodes.ports.values import Transform
from ur_nodes.ros2.node import RosNode

sys.modules["rclpy.type_hash"] = None
rclpy.init()
node = RosNode("mover")
try:
    node.transforms
except UserError as problem:
    print(problem.diagnostics[0].message)
    print(problem.diagnostics[0].help)
node.close()
rclpy.shutdown()
"""


@pytest.mark.timeout(300)
def test_ports_keep_their_contract_on_humble_but_for_the_publishers_of_messages(session: Ros2Session) -> None:
    program = session.run(str(AS_HUMBLE), *CHECKS, within=240.0)
    assert program.stdout, program.stderr
    failures = json.loads(program.stdout.splitlines()[-1])
    assert {*failures} == NEEDS_NUMBERS, failures


def test_message_that_humble_does_not_have_is_named_with_its_package(session: Ros2Session) -> None:
    session.environment["ROS_DISTRO"] = "humble"
    done = session.run("-c", WITHOUT_HASHES, within=60.0)
    assert done.stdout.splitlines() == [
        "ROS 2 Humble has no tf2_msgs, expected it for messages of the type tf2_msgs/TFMessage",
        "sudo apt install ros-humble-tf2-msgs",
    ], done.stderr
