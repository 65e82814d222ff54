"""The control groups of a computer of the bench.

systemd-nspawn without a systemd around it makes the group `payload` below the one that it runs in. Two computers in one
group take each other's processes for their own: one that stops waits 90 s for each service of the other to end.
"""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

MOUNTS = Path("/proc/self/mountinfo")


def make_groups(name: str) -> list[str]:
    """Make a group in each hierarchy that systemd uses; their folders. None where this computer allows none."""
    made = []
    for hierarchy in _find_hierarchies(MOUNTS.read_text()):
        folder = hierarchy / name
        with suppress(OSError):
            folder.mkdir(exist_ok=True)
            made.append(str(folder))
    return made


def remove_groups(folders: Sequence[str]) -> None:
    """Remove groups that no process is in any more, with those below them."""
    for folder in map(Path, folders):
        for below in sorted(folder.rglob("*/"), reverse=True):
            with suppress(OSError):
                below.rmdir()
        with suppress(OSError):
            folder.rmdir()


def _find_hierarchies(mounts: str) -> list[Path]:
    """The folders of the hierarchies in the text of mountinfo (proc(5)): the unified one, and systemd's older one."""
    found = []
    for line in mounts.splitlines():
        place, _, kind = line.partition(" - ")
        type_, _, options = kind.split(" ", 2)
        if type_ == "cgroup2" or (type_ == "cgroup" and "name=systemd" in options.split(",")):
            found.append(Path(place.split()[4]))
    return found
