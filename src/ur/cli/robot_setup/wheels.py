"""`ur robot wheels`: the test of a base's wheels, off the ground."""

from pathlib import Path

import click

from ur.cli.robots.shell import run_in_front, run_ssh
from ur.request.environment import PACKAGE
from ur.request.remote.connection import connect_robot, robot_address
from ur.robot.base import load_base
from ur.robot.setup.login import Task
from ur.robot.ssh.address import Address
from ur.robot.wheels import OwnBase, copy_wiring, find_own_base, remote_line
from ur.source.diagnostic import UserError, error_about


@click.command("wheels")
@click.argument("robot", required=False)
@click.option("--here", is_flag=True, help="The base is plugged into this computer.")
@click.option("--base", metavar="BASE", help="The base. [default: the robot's]")
@click.option("--variant", default="", help="The variant of BASE.")
@click.option("--device", default="", metavar="FILE", help="The device of its board. [default: that of the base file]")
@click.option(
    "--package",
    default=str(PACKAGE),
    metavar="FOLDER",
    type=click.Path(file_okay=False),
    help="The folder whose `bases/` has BASE. [default: this project's]",
)
def wheels(robot: str | None, here: bool, base: str | None, variant: str, device: str, package: str) -> int:
    """Test the wheels of a base, off the ground: forward, back, left and right by 10 cm.

    It asks before a wheel turns, and after each motion whether the wheels turned as they should. It compares the counts
    of the encoders with that. A motor or an encoder that is swapped or reversed is written into the base file, as
    `wiring` of its `driver`. The programs of the robot have to be stopped before.
    """
    if here and robot:
        raise click.UsageError("--here and ROBOT cannot be used together")
    if here:
        return test_here(find_own_base(package, base, variant), device)
    if base or device:
        raise click.UsageError("--base and --device are for --here: a robot knows its base")
    return test_there(robot_address(robot), package)


def test_here(own: OwnBase, device: str) -> int:
    """Test the base of this computer; return the exit code."""
    words = ["--package", own.package, "--base", own.name, "--variant", own.variant, "--device", device]
    program = str(Path(PACKAGE, "lib", "node"))
    return run_in_front([program, "ur_nodes.drivers.wheels.program", *words])


def test_there(address: Address, package: str) -> int:
    """Test the base of a robot there, with this terminal, and put its wiring into the base file here, too."""
    code = run_ssh(address, ["-t"], [remote_line()], escaped=True)
    if code not in (0, 1):
        return code
    with connect_robot(address) as shell:
        try:
            path = copy_wiring(shell, package)
        except OSError as problem:
            raise UserError(
                error_about(package, f"its base file cannot be written: {problem.strerror}", rule="no-file")
            ) from None
    if path:
        click.echo(f"written to {path}, too: the next 'ur robot setup' keeps it")
    return code


def offer_wheel_test(task: Task, *, ask: bool) -> None:
    """After a set-up, test the wheels if the user wants it, where a driver of this project drives the base."""
    driver = load_base(PACKAGE, task.robot.base, task.robot.variant).driver
    if driver is None or not driver.protocol or not task.robot.programs or task.robot.ros2:
        return
    if ask and click.confirm("Test the wheels now? The robot has to stand with all wheels off the ground."):
        test_there(task.later, str(PACKAGE))
    else:
        click.echo(f"test the wheels once, with the robot off the ground: ur robot wheels {task.robot.name}")
