"""`ur robot calibrate`: the lidar and the wheels of a robot, as its driving has shown them."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING

import click

from ur.cli.changing import DRY_RUN, PASSWORD_FROM, become_root, show_changes
from ur.cli.output import read_lines
from ur.robot.robot_file import ROBOT_FILE
from ur.source.diagnostic import user_error, user_error_about

if TYPE_CHECKING:
    from ur.robot.base.calibration import Calibration
    from ur.robot.ssh.shell import Shell


@click.command("calibrate")
@click.argument("robot", required=False)
@click.option("--yes", is_flag=True, help="Write the robot file without a question.")
@PASSWORD_FROM
@DRY_RUN
def calibrate(robot: str | None, yes: bool, password_from: int | None, dry_run: bool) -> int:
    """Correct the yaw of a robot's lidar and the size of its wheels, by what its driving has shown.

    While a program localises the robot or makes a map, it compares what the wheels and the scans report. After 10 m
    with turns, it knows how far the lidar is turned, and by how much the wheels' radius and distance are off. This
    writes them into the robot file, after a question; this project's drivers use them from their next start on. For a
    simulated robot it prints the argument to start it with.
    """
    from ur.devices.driver_health import OBSERVE_DRIVERS
    from ur.request.environment import current_selection
    from ur.request.remote.connection import connect_robot, robot_address
    from ur.robot.ssh.shell import LocalShell

    if robot is None and current_selection(os.environ).simulated:
        _, found = read_figures(LocalShell().run(OBSERVE_DRIVERS).out, "the simulated robot")
        click.echo(f"start it with: calibration:='{found.write()}'")
        return 0
    address = robot_address(robot)
    with connect_robot(address) as shell:
        used, found = read_figures(shell.run(OBSERVE_DRIVERS).out, address.host)
        if used is None:
            text = f"{address.host}: its drivers are not of this project, and use no robot file"
            help_ = "correct the pose of the lidar in its URDF, and the wheels in the settings of their driver"
            raise user_error(text, rule="foreign-drivers", help=help_)

        def agree() -> bool:
            if dry_run or not (yes or click.confirm(f"write this into the robot file of {address.host}?")):
                return False
            become_root(shell, read_lines(password_from, "--password-from", 1)[0])
            return True

        if write_file(shell, address.user, used.then(found), agree):
            click.echo("calibrated; start what runs there again: its drivers read the file when they start")
    return 0


def write_file(
    shell: Shell, user: str, calibration: Calibration, agree: Callable[[], bool], path: str = str(ROBOT_FILE)
) -> bool:
    """Show the change of the robot file, and make it if the user agrees. Raises UserError if there is no such file."""
    from ur.robot.base.calibration import write_calibration
    from ur.robot.setup.engine import apply_states, gather, plan_changes
    from ur.robot.setup.facts import FactsRequest
    from ur.robot.setup.wanted import WantedFile

    request = FactsRequest(user, files=frozenset({path}))
    state = gather(shell, request).file(path)
    if state.text is None:
        help_ = "set the robot up: ur robot setup"
        raise user_error_about(shell.destination, f"there is no {path}", rule="no-robot-file", help=help_)
    wanted = WantedFile("calibration", path, write_calibration(state.text, calibration), state.mode)
    show_changes(plan_changes([wanted], gather(shell, request | wanted.request(user))))
    if not agree():
        return False
    apply_states(shell, lambda _: [wanted], user, request, root=path == str(ROBOT_FILE), report=lambda _: None)
    return True


def read_figures(observed: str, name: str) -> tuple[Calibration | None, Calibration]:
    """Print what a robot's driving has shown; return the calibration that its drivers use, and what to add to it.

    The first one is None without drivers of this project. Raises UserError if there is nothing to correct, or nothing
    known.
    """
    from ur.devices.driver_health import MotionRecord, describe_errors, parse_drivers, parse_records
    from ur.robot.base.calibration import Calibration, parse_calibration

    records = parse_records(observed, MotionRecord)
    if not records:
        help_ = (
            "drive 10 m with turns, with 'ur run keyboard_navigate' or 'ur run make_map', and run this while that runs"
        )
        raise user_error(f"{name}: nothing is known of its lidar and wheels yet", rule="no-figures", help=help_)
    record = max(records, key=lambda each: each.metres)
    if not (text := describe_errors(record)):
        text = f"{name}: after {record.metres:.0f} m, lidar and wheels are as described"
        raise user_error(text, rule="calibrated", help="nothing is to be done")
    text = f"{name}: after {record.metres:.0f} m: {text}"
    found = Calibration(record.yaw, 1.0 + record.radius, 1.0 + record.separation)
    if found == Calibration():
        raise user_error(text, rule="wrong-place", help="measure it, and correct its pose in the base file")
    click.echo(text)
    used = [parse_calibration(each.calibration, name) for each in parse_drivers(observed) if each.calibration]
    return (used[0] if used else None), found
