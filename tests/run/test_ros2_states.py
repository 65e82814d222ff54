"""Lifecycle nodes of a launch file for ROS 2, changed through their own services."""

import os
import signal
from typing import Any

import pytest
from tests.ros2_session import PYTHON, ROOT
from tests.run.ros2_world import Ros2World

NODE = """
import sys
import rclpy
from rclpy.lifecycle import LifecycleNode
rclpy.init(args=sys.argv)
node = LifecycleNode("lc")
try:
    rclpy.spin(node)
except BaseException:
    pass
"""
FILE = """
from launch import LaunchDescription
from launch.actions import *
from launch.events import matches_action
from launch_ros.actions import *
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
from lifecycle_msgs.msg import Transition
def change(node, step):
    return EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node), transition_id=step))
def generate_launch_description():
    lc = LifecycleNode(package='demo', executable='states', name='lc', namespace='')
    return LaunchDescription([
        lc,
        RegisterEventHandler(OnStateTransition(target_lifecycle_node=lc, goal_state='inactive', entities=[
            LogInfo(msg='is inactive'), change(lc, Transition.TRANSITION_ACTIVATE)])),
        RegisterEventHandler(OnStateTransition(target_lifecycle_node=lc, goal_state='active', entities=[
            Node(package='demo', executable='show', arguments=['active'])])),
        change(lc, Transition.TRANSITION_CONFIGURE),
    ])
"""


AUTOSTART = """
from launch import LaunchDescription
from launch.actions import *
from launch_ros.actions import *
from launch_ros.event_handlers import OnStateTransition
def generate_launch_description():
    lc = LifecycleNode(package='demo', executable='states', name='lc', namespace='', autostart=True)
    return LaunchDescription([
        lc,
        RegisterEventHandler(OnStateTransition(target_lifecycle_node=lc, goal_state='active', entities=[
            Node(package='demo', executable='show', arguments=['active'])])),
    ])
"""


@pytest.mark.parametrize("autostart", [False, True])
def test_states_of_a_lifecycle_node_start_what_the_file_says(world: Any, *, autostart: bool) -> None:
    if not PYTHON.exists():
        pytest.skip("no wheels of ROS 2 for this processor")
    ros2 = Ros2World(world)
    world.environment["AMENT_PREFIX_PATH"] += f"{os.pathsep}{ROOT}/.ros2"
    file = ros2.folder / "states.py"
    file.write_text(NODE)
    program = ros2.folder / "prefix/lib/demo/states"
    program.write_text(f'#!/bin/bash\nexec {ROOT}/ubiquity_launches/lib/node {file} "$@"\n')
    program.chmod(0o755)
    run = world.ur("launch", "--plain", ros2.write("a.launch.py", AUTOSTART if autostart else FILE))
    ros2.until_shown(run, 1)
    assert ros2.argv() == [["active", "--ros-args"]]
    run.until("transition 1: done", "transition 3: done")  # programs of their own, which may report late
    assert autostart or run.text.index("is inactive") < run.text.index("transition 3: done")
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0, run.text
    run.wait_nothing_left()
