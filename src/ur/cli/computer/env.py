"""`ur env`: the variables that make a shell follow the selection."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING

import click

from ur.cli.output import write_exactly
from ur.request.environment import current_selection, environment_changes, render_exports
from ur.source.diagnostic import UserError, error

if TYPE_CHECKING:
    from ur.robot.robot_file import Ros2Robot
    from ur.robot.selection import Selection


@click.command("env")
@click.option(
    "--graph",
    is_flag=True,
    help="Ask the robot for its domain and middleware, too, so that RViz 2 and ros2 of this computer see its nodes.",
)
def command(graph: bool) -> int:
    """Print the lines that let a shell follow the selection.

    Evaluate it, once or in ~/.bashrc: eval "$(ur env)". Then roslaunch, rosrun and every other ROS tool find the
    packages and the master of the selected robot. It can be evaluated repeatedly.

    Programs of this project need no --graph: on a robot with ROS 2 they run on the robot.
    """
    selection = current_selection(os.environ)
    changes = environment_changes(selection, os.environ)
    if graph and not selection.simulated:
        changes |= guest_changes(selection, changes.get("ROS_VERSION", os.environ.get("ROS_VERSION", "1")))
    write_exactly(render_exports(changes))
    return 0


def guest_changes(selection: Selection, version: str, read: Callable[[str], Ros2Robot] | None = None) -> dict[str, str]:
    """Return the variables with which ROS of this `version` joins the selected robot's graph. Raises UserError."""
    if version != "2":
        message = "--graph is for ROS 2, which this computer does not use"
        raise UserError(error(message, rule="bad-options", help=f"ur use {selection.robot} --ros 2"))
    return (read or _read_robot)(selection.robot).guest_variables(f"{selection.robot}.local")


def _read_robot(name: str) -> Ros2Robot:
    from ur.request.remote.connection import connect_robot, robot_address
    from ur.request.remote.over_ssh import read_robot

    with connect_robot(robot_address(name)) as shell:
        return read_robot(shell)[1]
