"""Inspection of a robot before its set-up: its ROS 2, if installed, and the settings of its nodes."""

from collections.abc import Callable
from dataclasses import replace

from ur.robot.robot_file import ROBOT_FILE, Ros2Robot, parse_robot_file
from ur.robot.ros2.observe import inspect_ros2
from ur.robot.ros2.seen_graph import Ros2
from ur.robot.setup.ros2.states import find_ros2
from ur.robot.setup.ros2.take_over import list_topics
from ur.robot.ssh.shell import Shell, quote

_ROS1 = "command -v roslaunch rosmaster || ls /opt/ros/noetic/bin/roslaunch"


def find_robot_ros2(shell: Shell) -> tuple[Ros2Robot, dict[str, str]] | None:
    """Find the ROS 2 of a robot, and the velocity topics of its base by their types.

    None without ROS 2, or if ROS 1 is installed as well. Raises UserError if the connection breaks, the release is too
    old, or its robot file is invalid.
    """
    found = inspect_robot(shell)
    if not found.present or shell.run(f"{{ {_ROS1}; }} >/dev/null 2>&1").code == 0:
        return None
    present = parse_robot_file(shell.run(f"cat {ROBOT_FILE} 2>/dev/null").out, f"{shell.destination}:{ROBOT_FILE}")
    ros2 = find_ros2(shell.destination, found, present.ros2 if present else None)
    assert ros2
    return ros2, list_topics(found.graph, ros2.commands) if found.graph else {}


def inspect_robot(shell: Shell) -> Ros2:
    """Inspect a robot, and its nodes.

    Processes are read as root, since they may belong to any user; nodes are queried as the user who logs in, whose
    shared memory they can open. Raises UserError if the connection breaks.
    """
    found = inspect_ros2(shell, (), graph=False, root=True)
    if not found.processes:
        return found
    environment = {name: value for name, value in found.variables.items() if name != "ROS_DISTRO"}
    return replace(found, graph=inspect_ros2(shell, (), environment=environment).graph)


def restart_silent_units(shell: Shell, report: Callable[[str], None]) -> int:
    """Restart units whose shared memory was removed by a logout, so that new nodes reach theirs; return the count."""
    found = inspect_ros2(shell, (), graph=False, root=True)
    units = sorted({each.unit for each in found.processes if each.lost and each.unit})
    for unit in units:
        report(f"restart of {unit}, whose shared memory a logout has removed")
        shell.run(quote("systemctl", "restart", unit), root=True)
    return len(units)
