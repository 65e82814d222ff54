"""`ur unmount`: unmount folders that `ur mount` has mounted."""

from __future__ import annotations

import click

from ur.cli.workspace.mount import read_mounts
from ur.request.remote.connection import robot_address
from ur.robot.mount import mounts_of, unmount_command
from ur.robot.ssh.shell import run_process
from ur.source.printable import printable
from ur.source.progress_line import show_progress


@click.command("unmount")
@click.argument("robot", required=False)
def command(robot: str | None) -> int:
    """Unmount the folders of a robot.

    Works also if the robot is off or cannot be reached.
    """
    address = robot_address(robot)
    found = mounts_of(read_mounts(), address.host)
    if not found:
        click.echo(f"no folder of {address.host} is mounted")
    code = 0
    for mount in found:
        what = f"unmounting {mount.target}"
        with show_progress(what):
            done = run_process(unmount_command(mount.target), timeout=20, what=what)
        click.echo(f"{mount.target}: " + ("unmounted" if done.code == 0 else printable(done.err.strip())))
        code = max(code, 1 if done.code else 0)
    return code
