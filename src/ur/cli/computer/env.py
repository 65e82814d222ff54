"""`ur env`: the variables that make a shell follow the selection."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING

import click

from ur.cli.output import write_exactly
from ur.request.environment import current_selection, environment_changes, render_exports
from ur.source.diagnostic import user_error

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
        version, distro = (changes.get(each, os.environ.get(each, "")) for each in ("ROS_VERSION", "ROS_DISTRO"))
        changes |= guest_changes(selection, version, distro)
    write_exactly(render_exports(changes))
    return 0


def guest_changes(
    selection: Selection, version: str, distro: str, read: Callable[[str], Ros2Robot] | None = None
) -> dict[str, str]:
    """Return the variables with which ROS of this version and release joins the selected robot's graph.

    Raises UserError if it does not understand the robot's nodes.
    """
    from ur.robot.ros2.seen_graph import mixes

    if version != "2":
        message = "--graph is for ROS 2, which this computer does not use"
        raise user_error(message, rule="bad-options", help=f"ur use {selection.robot} --ros 2")
    robot = (read or _read_robot)(selection.robot)
    if not mixes(distro, robot.distro):
        names = f"ROS 2 {distro.capitalize()}, and {selection.robot} {robot.distro.capitalize()}"
        message = f"this computer has {names}: nodes of the two raise exceptions when they discover one another"
        raise user_error(message, rule="ros2-release-mix", help="the page and the keys need no ROS here: ur web")
    return robot.guest_variables(f"{selection.robot}.local")


def _read_robot(name: str) -> Ros2Robot:
    from ur.request.remote.connection import connect_robot, robot_address
    from ur.request.remote.over_ssh import read_robot

    with connect_robot(robot_address(name)) as shell:
        return read_robot(shell)[1]
