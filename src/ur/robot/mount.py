"""Folders of robots, mounted on this computer with sshfs: command lines, and the list of mounts. Pure."""

import re
from dataclasses import dataclass
from pathlib import Path

from ur.robot.ssh.address import Address

REMOTE = "catkin_ws/src"
# A broken connection is detected within 3 x 2 s; from then on every access fails within ConnectTimeout instead of
# blocking the program, and works again when the network is back.
OPTIONS = (
    *("reconnect", "ServerAliveInterval=2", "ServerAliveCountMax=3", "ConnectTimeout=3", "BatchMode=yes"),
    *("StrictHostKeyChecking=yes", "idmap=user", "auto_cache"),
)


@dataclass(frozen=True, slots=True)
class MountedFolder:
    """A mounted folder: `source` is the argument of sshfs, for instance ros@bob.local:catkin_ws/src."""

    source: str
    target: Path


def mount_command(address: Address, remote: str, target: Path) -> list[str]:
    """Return the arguments that mount a folder of a robot; a relative `remote` begins at its user's home folder."""
    host = f"[{address.host}]" if ":" in address.host else address.host
    return ["sshfs", f"{address.user}@{host}:{remote}", str(target), "-o", ",".join(OPTIONS)]


def unmount_command(target: Path) -> list[str]:
    """Return the arguments that unmount a folder, also if the robot is away (then when the last program leaves it)."""
    return ["fusermount3", "-u", "-z", str(target)]


def default_target(home: Path, name: str) -> Path:
    """Return the default mount point of a robot's workspace."""
    return home / "robots" / name


def parse_mounts(text: str) -> list[MountedFolder]:
    """Parse the sshfs mounts in the text of /proc/self/mounts (proc(5): octal escapes for blanks)."""
    rows = (line.split() for line in text.splitlines())
    return [
        MountedFolder(_unescape(row[0]), Path(_unescape(row[1])))
        for row in rows
        if len(row) > 2 and row[2] == "fuse.sshfs"
    ]


def mounts_of(mounts: list[MountedFolder], host: str) -> list[MountedFolder]:
    """Return the mounts of a robot."""
    return [mount for mount in mounts if re.fullmatch(rf"(.*@)?\[?{re.escape(host)}\]?:.*", mount.source)]


def _unescape(text: str) -> str:
    return re.sub(r"\\([0-7]{3})", lambda match: chr(int(match[1], 8)), text)
