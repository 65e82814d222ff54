"""The files of /proc and /sys with the figures of this computer, and its disk."""

import os
from contextlib import suppress
from pathlib import Path

from ur_nodes.web.status.computer import ComputerTexts

_LONGEST = 1 << 16  # bytes of a file


def read_computer(root: Path = Path("/")) -> ComputerTexts:
    """Read the files below `root`."""
    zones = sorted((root / "sys/class/thermal").glob("thermal_zone*"))[:32]
    return ComputerTexts(
        stat=_read(root / "proc/stat"),
        meminfo=_read(root / "proc/meminfo"),
        loadavg=_read(root / "proc/loadavg"),
        uptime=_read(root / "proc/uptime"),
        wireless=_read(root / "proc/net/wireless"),
        zones=tuple((_read(zone / "type"), _read(zone / "temp")) for zone in zones),
    )


def read_disk(path: Path) -> list[int] | None:
    """Return the used bytes and the size of the file system of a path, as an ordinary user sees it."""
    with suppress(OSError):
        found = os.statvfs(path)
        return [found.f_frsize * (found.f_blocks - found.f_bfree), found.f_frsize * found.f_blocks]
    return None


def _read(path: Path) -> str:
    with suppress(OSError), path.open("rb") as file:
        return file.read(_LONGEST).decode("utf-8", "replace")
    return ""
