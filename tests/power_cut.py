"""A disk that loses what was not flushed: a file system in a file, which an ioctl of ext4 shuts down as a power cut."""

import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

_SHUT_DOWN = "import fcntl, os, struct; fcntl.ioctl(os.open('disk', os.O_RDONLY), 0x8004587D, struct.pack('I', 2))"
# Names may reach this disk long before contents do, as on file systems that do not help careless programs.
_OPTIONS = "loop,noauto_da_alloc,data=writeback,commit=300"
_RUN = f"""\
set -e
mount -o {_OPTIONS} disk.img disk
(cd disk && {{ eval "$PREPARE"; }}); sync -f disk
(cd disk && "$PYTHON" -I -c "$ACTION")
[ -z "$COMMIT" ] || {{ : >disk/other; sync disk/other; }} # somebody else's fsync takes all names to the disk
"$PYTHON" -I -c "$SHUT_DOWN"
umount disk; mount -o loop disk.img disk; cp -a disk/. after; umount disk
"""


@cache
def can_cut_power() -> bool:
    """Return whether this user may mount a disk of its own on this computer."""
    if os.geteuid() or not shutil.which("mkfs.ext4") or not shutil.which("unshare"):
        return False
    return not subprocess.run(["losetup", "-f"], capture_output=True, check=False).returncode


def cut_power(folder: Path, action: str, *, prepare: str = ":", others_flush: bool = False) -> Path:
    """Run `action`, Python, on a new disk, cut its power the moment that has ended, and return what was left.

    What `prepare`, a shell script, has written is on the disk before. With `others_flush`, names are committed at the
    end, and contents are not.
    """
    for name in ("disk", "after"):
        (folder / name).mkdir()
    with (folder / "disk.img").open("wb") as image:
        image.truncate(32 << 20)
    subprocess.run(["mkfs.ext4", "-q", "disk.img"], cwd=folder, check=True)
    variables = {
        "PREPARE": prepare,
        "ACTION": action,
        "COMMIT": "1" if others_flush else "",
        "SHUT_DOWN": _SHUT_DOWN,
        "PYTHON": sys.executable,
        "HOME": str(folder / "disk"),
    }
    environment = {key: value for key, value in os.environ.items() if not key.startswith("XDG_")} | variables
    # A namespace of its own: when this is killed, nothing stays mounted.
    command = ["unshare", "--mount", "--propagation", "private", "sh", "-c", _RUN]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "after"
