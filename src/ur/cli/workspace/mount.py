"""`ur mount`: mount a folder of a robot, and unmount it."""

import errno
import os
from contextlib import suppress
from pathlib import Path

import click

from ur.request.remote.connection import connect_robot, robot_address
from ur.robot.mount import (
    REMOTE,
    MountedFolder,
    default_target,
    mount_command,
    mounts_of,
    parse_mounts,
    unmount_command,
)
from ur.robot.ssh.address import Address
from ur.robot.ssh.shell import quote, run_process
from ur.source.diagnostic import UserError, user_error
from ur.source.printable import printable
from ur.source.progress_line import show_progress

SECONDS = 30.0


@click.command("mount")
@click.argument("robot", required=False)
@click.option("--at", type=click.Path(path_type=Path), help="Where. [default: ~/robots/ROBOT]")
@click.option("--over", is_flag=True, help="Over ~/catkin_ws/src: what is there is hidden until the unmount.")
@click.option("--folder", default=REMOTE, show_default=True, help="Which folder of the robot.")
@click.option("--undo", is_flag=True, help="Unmount the folders of the robot, also when it is off.")
def command(robot: str | None, at: Path | None, over: bool, folder: str, undo: bool) -> int:
    """Mount a folder of a robot here, or unmount it.

    Without the network, programs get an error within seconds instead of waiting, and continue when it is back.
    """
    if at and over:
        raise click.UsageError("--at and --over are two places, expected one of them")
    address = robot_address(robot)
    if undo:
        return _undo(address)
    target = (
        at or (Path.home() / REMOTE if over else default_target(Path.home(), address.host.split(".")[0]))
    ).absolute()
    mounted = _mounts_at(target)
    if mounts_of(mounted, address.host):
        if not _is_dead(target):
            click.echo(f"{target}: already mounted")
            return 0
        _unmount(target)
        mounted = _mounts_at(target)
    if mounted:
        raise _problem(
            f"{target}: {mounted[0].source} is mounted there", "ur mount --undo, or choose another place with --at"
        )
    with connect_robot(address) as shell:  # for its error messages, which are better than those of sshfs
        if shell.run(f"cd && [ -d {quote(folder)} ]").code:
            raise _problem(f"{address}: {folder} is not there, expected a folder", "name another one with --folder")
    made = _make_folder(target, hide=over)
    try:
        what = f"mounting a folder of {address}"
        with show_progress(what):
            done = run_process(mount_command(address, folder, target), timeout=SECONDS, what=what)
        if done.code:
            reported = (done.err.strip().splitlines() or ["sshfs printed nothing"])[-1]
            raise _problem(f"{address}: {folder} could not be mounted: {reported}", f"ur doctor {address}")
    except BaseException:
        if mounts_of(_mounts_at(target), address.host):  # sshfs mounts before its first request is answered
            _unmount(target)
        if made:
            with suppress(OSError):
                target.rmdir()
        raise
    click.echo(f"{target}: {folder} of {address}")
    return 0


def _undo(address: Address) -> int:
    """Unmount all folders of a robot; return 1 if one of them is in use."""
    found = mounts_of(read_mounts(), address.host)
    if not found:
        click.echo(f"no folder of {address.host} is mounted")
    codes = []
    for mount in found:
        what = f"unmounting {mount.target}"
        with show_progress(what):
            done = run_process(unmount_command(mount.target), timeout=20, what=what)
        click.echo(f"{mount.target}: " + ("unmounted" if done.code == 0 else printable(done.err.strip())))
        codes.append(done.code)
    return 1 if any(codes) else 0


def read_mounts() -> list[MountedFolder]:
    """Return the folders that sshfs has mounted on this computer."""
    return parse_mounts(Path("/proc/self/mounts").read_text(encoding="utf-8"))


def _mounts_at(target: Path) -> list[MountedFolder]:
    return [mount for mount in read_mounts() if mount.target == target]


def _is_dead(target: Path) -> bool:
    """Return whether the sshfs of a mount was killed, so that every access fails until it is unmounted."""
    try:
        target.stat()
    except OSError as problem:
        return problem.errno == errno.ENOTCONN
    return False


def _unmount(target: Path) -> None:
    done = run_process(unmount_command(target), timeout=20, what=f"unmounting {target}")
    if done.code:
        raise _problem(f"{target}: cannot be unmounted: {done.err.strip()}", f"fusermount3 -u -z {quote(str(target))}")


def _make_folder(target: Path, *, hide: bool) -> bool:
    """Create the folder to mount at, if necessary; return whether it was created.

    Raises UserError if it is unusable.
    """
    made = not target.exists()
    try:
        target.mkdir(parents=True, exist_ok=True)
        used = any(os.scandir(target)) and not hide
    except OSError as problem:
        raise _problem(
            f"{target}: {(problem.strerror or str(problem)).lower()}", "choose another place with --at"
        ) from None
    if used:
        raise _problem(f"{target} is not empty, expected an empty folder", "choose another place with --at")
    return made


def _problem(message: str, help: str) -> UserError:
    return user_error(message, rule="no-mount", help=help)
