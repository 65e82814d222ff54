"""The part of `ur robot setup` for robots with ROS 2."""

from __future__ import annotations

from dataclasses import replace

from ur.cli.changing import ChangeReporter
from ur.robot.robot_file import ROBOT_FILE
from ur.robot.setup.login import Task, open_robot
from ur.robot.setup.raspberry_pi.header import undo_header
from ur.robot.setup.robot import undo_ros2
from ur.robot.setup.robot_states import ViewerFacts
from ur.robot.setup.ros2.find import find_robot_ros2
from ur.robot.setup.ros2.mux_between import give_back, take_over
from ur.source.diagnostic import UserError, error


def find_ros2(task: Task, report: ChangeReporter) -> Task:
    """Return the task with the robot's ROS 2, which stays unchanged.

    If this first login had to change the password, the robot has the new one, and later logins may use it.
    """
    with open_robot(task, report) as shell:
        found = find_robot_ros2(shell)
        if task.new in shell.accepted:
            task = replace(task, first_contact=False)
    if found is None:
        return task
    ros2, topics = found
    where = f"domain {ros2.domain}" + (f", {ros2.middleware}" if ros2.middleware else "")
    kind = topics.get(ros2.commands, "").rpartition("/")[2]
    commands = f"{ros2.commands}, {kind}" if kind else ros2.commands
    report(f"ROS 2 {ros2.distro.capitalize()} ({where}; commands: {commands}), which stays as it is")
    others = [f"{name} ({kind.rpartition('/')[2]})" for name, kind in topics.items() if name != ros2.commands]
    if others:
        report(f"the base takes {', '.join(others)}, too; ros_commands in {ROBOT_FILE} names the one that is used")
    return replace(task, robot=replace(task.robot, ros2=ros2, master=False), devices=())


def put_mux_between(task: Task, report: ChangeReporter) -> tuple[Task, int]:
    """Install the mux before the base of a robot with ROS 2; return the task and the number of changes.

    The task has the base's topic. Raises UserError if the robot has no ROS 2, or its driver did not subscribe to the
    other topic.
    """
    if task.robot.ros2 is None:
        message = f"{task.robot.name} has no ROS 2, expected a robot with ROS 2 and --take-over"
        raise UserError(error(message, rule="usage", help="leave --take-over out"))
    with open_robot(replace(task, address=task.later, host_key=None, first_contact=False), report) as shell:
        robot, count = take_over(shell, task.robot, report)
    return replace(task, robot=robot), count


def take_back_ros2(task: Task, viewer: ViewerFacts) -> int:
    """Revert the set-up; return the exit code.

    With ROS 1 it reverts the header of a Raspberry Pi alone. Raises UserError if that was not changed either.
    """
    report = ChangeReporter(task.robot.name)
    task = find_ros2(task, report)
    if task.robot.ros2 is None:
        with open_robot(task, report) as shell:
            count = undo_header(shell, task.address.user, report)
        if count:
            report("the rest of the set-up stays: docs/how-to/uninstall.md has the steps")
            return 0
        message = f"{task.robot.name} has no ROS 2, or ROS 1 as well, expected a robot with ROS 2 alone"
        raise UserError(error(message, rule="usage", help="docs/how-to/uninstall.md has the steps"))
    with open_robot(task, report) as shell:
        count = give_back(shell, report)
    count += undo_ros2(task, viewer, report)
    report(f"{count} changes taken back; packages stay" if count else "nothing to take back")
    return 0
