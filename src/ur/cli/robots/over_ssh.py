"""Programs and the page of a robot with ROS 2: they run on the robot, with this terminal."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import nullcontext

from ur.cli.robots.shell import run_in_front
from ur.request.environment import add_own_package
from ur.request.launch_request import LaunchFiles
from ur.request.programs import Program, find_launch_file
from ur.request.remote.connection import connect_robot, robot_address
from ur.request.remote.over_ssh import guard_link, program_arguments, read_robot, remote_script
from ur.robot.discovery.record import load_records, records_folder
from ur.robot.selection import Selection
from ur.source.diagnostic import UserError, error

FIRST_PORT = 8090


def is_over_ssh(selection: Selection) -> bool:
    """Return whether the selected robot is another computer that was set up with ROS 2."""
    if selection.simulated or os.uname().nodename.split(".")[0] == selection.robot:
        return False
    return any(each.name == selection.robot and each.ros for each in load_records(records_folder(os.environ)))


def run_there(selection: Selection, program: Program, options: Sequence[str], argv: Sequence[str]) -> int:
    """Run a program on the robot, with this terminal; return its exit code. Raises UserError.

    Keys drive only while the connection is verified, see `guard_link`.
    """
    from ur.launchfile.world.system import SystemWorld

    path = find_launch_file(program)
    declared = LaunchFiles([str(path)], SystemWorld(add_own_package(os.environ))).declared if path else ()
    terminal = sys.stdin.isatty() and sys.stdout.isatty()
    with connect_robot(robot_address(selection.robot)) as shell:
        robot, ros2 = read_robot(shell)
        with guard_link(shell) if terminal else nullcontext("") as link:
            words = ["run", program.name, *options, *program_arguments(robot, argv, declared)]
            script = remote_script(robot.name, ros2, words, link)
            sys.stdout.flush()
            return run_in_front([*shell.words, "-t" if terminal else "-T", "--", shell.destination, script])


def serve_there(selection: Selection, port: int | None, options: Sequence[str]) -> int:
    """Serve the page on the robot, on the loopback interfaces of both computers; return the exit code.

    Raises UserError.
    """
    port = port or FIRST_PORT
    with connect_robot(robot_address(selection.robot)) as shell:
        robot, ros2 = read_robot(shell)
        words = ["web", "--no-browser", "--port", str(port), *options]
        script = remote_script(robot.name, ros2, words)
        if not shell.forward(port):
            message = f"port {port} of this computer is in use, or the robot's ssh server forwards none"
            raise UserError(error(message, rule="no-port", help="choose another one: ur web --port PORT"))
        sys.stdout.flush()
        return run_in_front([*shell.words, "-t", "--", shell.destination, script])
