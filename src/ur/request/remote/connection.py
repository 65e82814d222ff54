"""Connections to the robot of a command: the named ROBOT, else the selected one."""

from __future__ import annotations

import os
from collections.abc import Sequence
from contextlib import AbstractContextManager

from ur.request.environment import current_selection
from ur.robot.discovery.record import find_user, records_folder
from ur.robot.ssh.address import Address, parse_address
from ur.robot.ssh.openssh import SshShell, connect
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError, error
from ur.source.progress_line import show_progress


def connect_robot(
    address: Address, *, password: Secret | None = None, options: Sequence[str] = ()
) -> AbstractContextManager[SshShell]:
    """Log in as `ur.robot.ssh.openssh.connect` does; the terminal shows the robot that is waited for."""
    return connect(address, password=password, options=options, waiting=show_progress)


def robot_address(robot: str | None) -> Address:
    """Return the address of ROBOT on a command line. Raises UserError if none is given and none is selected."""
    if robot is None:
        selected = current_selection(os.environ)
        if selected.simulated:
            raise UserError(
                error(
                    "no robot given, and the selected robot is simulated, expected a real robot",
                    rule="no-robot",
                    help="name a robot, or select one with 'ur use ROBOT'; 'ur robots' lists them",
                )
            )
        robot = selected.robot
    name = robot.rpartition("@")[2].removesuffix(".local")
    return parse_address(robot, find_user(name, records_folder(os.environ)))
