"""Inspection of a robot before its set-up: whether it has ROS 2, and where its nodes are."""

from __future__ import annotations

from dataclasses import replace

from ur.robot.robot_file import Ros2Robot
from ur.robot.ros2.observe import inspect_ros2
from ur.robot.setup.ros2.states import find_ros2
from ur.robot.ssh.shell import Shell

_ROS1 = "command -v roslaunch rosmaster || ls /opt/ros/noetic/bin/roslaunch"


def find_robot_ros2(shell: Shell) -> Ros2Robot | None:
    """Find the ROS 2 of a robot; None where it has none, or has ROS 1 as well.

    Processes are read as root, since they may be those of any user; nodes are asked as the user who logs in, whose
    shared memory they can open. Raises UserError: the connection is lost, or the release is too old.
    """
    found = inspect_ros2(shell, (), graph=False, root=True)
    if not found.present or shell.run(f"{{ {_ROS1}; }} >/dev/null 2>&1").code == 0:
        return None
    if found.processes:
        environment = {name: value for name, value in found.variables.items() if name != "ROS_DISTRO"}
        found = replace(found, graph=inspect_ros2(shell, (), environment=environment).graph)
    return find_ros2(shell.place, found)
