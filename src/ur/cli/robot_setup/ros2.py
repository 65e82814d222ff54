"""The share of `ur robot setup` that is about robots with ROS 2."""

from __future__ import annotations

from dataclasses import replace

from ur.cli.changing import ChangeReporter
from ur.robot.setup.login import Task, open_robot
from ur.robot.setup.robot import take_back
from ur.robot.setup.robot_states import ViewerFacts
from ur.robot.setup.ros2.find import find_robot_ros2
from ur.source.diagnostic import UserError, error


def find_ros2(task: Task, say: ChangeReporter) -> Task:
    """The task with the ROS 2 that the robot has, which then stays as it is.

    Where this first login had to change the password, the robot has the new one, and later logins may use it.
    """
    with open_robot(task, say) as shell:
        ros2 = find_robot_ros2(shell)
        if task.new in shell.accepted:
            task = replace(task, first_contact=False)
    if ros2 is None:
        return task
    where = f"domain {ros2.domain}" + (f", {ros2.middleware}" if ros2.middleware else "")
    say(f"ROS 2 {ros2.distro.capitalize()} ({where}; commands: {ros2.commands}), which stays as it is")
    return replace(task, robot=replace(task.robot, ros2=ros2, master=False), devices=())


def take_back_ros2(task: Task, viewer: ViewerFacts) -> int:
    """Take back what the set-up wrote; the exit code. Raises UserError: the robot has no ROS 2."""
    say = ChangeReporter(task.robot.name)
    task = find_ros2(task, say)
    if task.robot.ros2 is None:
        message = f"{task.robot.name} has no ROS 2, or ROS 1 as well, expected a robot with ROS 2 alone"
        raise UserError(error(message, rule="usage", help="docs/how-to/uninstall.md has the steps"))
    count = take_back(task, viewer, say)
    say(f"{count} changes taken back; packages stay" if count else "nothing to take back")
    return 0
