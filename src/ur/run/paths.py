"""Folders of runs, and the test for an address of this computer, as roslaunch and rospkg define them."""

import errno
import os
import socket
from collections.abc import Mapping
from pathlib import Path

from ur.source.diagnostic import Diagnostic, UserError, error

_ROOM = 1 << 20  # B, without which the first logs are not written


def ros_home(environment: Mapping[str, str]) -> str:
    """Return the working directory of nodes: ROS_HOME, else ~/.ros."""
    return environment.get("ROS_HOME") or str(Path(environment.get("HOME") or Path.home()) / ".ros")


def log_root(environment: Mapping[str, str]) -> str:
    """Return the folder that has one folder per run: ROS_LOG_DIR, else `log` in ROS_HOME."""
    return environment.get("ROS_LOG_DIR") or ros_home(environment) + "/log"


def make_run_folder(environment: Mapping[str, str], run_id: str) -> str:
    """Create the log folder of a run, which only the user can open, and `latest` beside it. Raises UserError."""
    root = Path(log_root(environment))
    folder = root / run_id
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as problem:
        raise UserError(_explain_unusable(folder, "ROS_LOG_DIR", problem)) from None
    latest = root / "latest"
    try:
        if latest.is_symlink():
            latest.unlink()
        if not latest.exists():
            latest.symlink_to(folder)
    except OSError:
        return str(folder)  # for convenience only
    return str(folder)


def make_home(environment: Mapping[str, str]) -> str:
    """Create the working directory of nodes, and check that it and the logs have room. Raises UserError."""
    home = Path(ros_home(environment))
    for folder, variable in ((home, "ROS_HOME"), (Path(log_root(environment)), "ROS_LOG_DIR")):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            probe = folder / f".room.{os.getpid()}"  # a quota may be used up where the disk is not
            try:
                probe.write_bytes(bytes(_ROOM))
            finally:
                probe.unlink(missing_ok=True)
        except OSError as problem:  # noqa: PERF203 - two folders
            raise UserError(_explain_unusable(folder, variable, problem)) from None
    return str(home)


def _explain_unusable(folder: Path, variable: str, problem: OSError) -> Diagnostic:
    if problem.errno in (errno.ENOSPC, errno.EDQUOT):
        what = "disk" if problem.errno == errno.ENOSPC else "quota"
        return error(
            f"the {what} of {folder} is full, expected {_ROOM >> 20} MB or more for logs",
            rule="full-disk",
            help=f"make room (df -h; 'rosclean purge' deletes old logs), or choose another disk with {variable}",
            subject=str(folder),
        )
    reason = (problem.strerror or str(problem)).lower()
    return error(
        f"folder {folder} cannot be made or written: {reason}",
        rule="bad-folder",
        help=f"{variable} chooses another place",
        subject=str(folder),
    )


def new_run_id() -> str:
    """Return a unique run id."""
    try:
        return Path("/proc/sys/kernel/random/uuid").read_text(encoding="ascii").strip()
    except OSError:
        import uuid

        return str(uuid.uuid4())


def is_local_address(address: str) -> bool:
    """Return whether a host name or address is that of this computer; False for an unknown name."""
    if address in ("", "localhost", "127.0.0.1", "::1"):
        return True
    try:
        found = socket.getaddrinfo(address, 0, type=socket.SOCK_DGRAM)
    except OSError:
        return False
    for family, kind, protocol, _, where in found:
        try:
            with socket.socket(family, kind, protocol) as probe:
                probe.bind(where)  # only a local address can be bound
                return True
        except OSError:  # noqa: PERF203 - a name may have several addresses
            continue
    return False
