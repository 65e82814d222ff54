"""Devices with a flashed system: their properties, and whether they may be written to."""

import os
import stat
from dataclasses import dataclass
from pathlib import Path

from ur.source.diagnostic import UserError, error


@dataclass(frozen=True, slots=True)
class DiskDevice:
    """A whole disk, as the kernel describes it."""

    path: Path
    model: str
    size: int

    def __str__(self) -> str:
        return f"{self.path} ({self.model}, {self.size / 1e9:.1f} GB)"


def is_device(path: Path) -> bool:
    """Return whether a path is a block device."""
    try:
        return stat.S_ISBLK(path.stat().st_mode)
    except OSError:
        return False


def check_device(path: Path, *, system: Path = Path("/sys"), processes: Path = Path("/proc")) -> DiskDevice:
    """Return the disk if no part of it is in use and the user may write to it.

    Raises UserError for a partition, a mounted disk, one that this computer uses, or one without write permission.
    """
    name = path.resolve().name
    folder = system / "class/block" / name
    if (folder / "partition").exists():
        whole = folder.resolve().parent.name
        raise _refuse(f"{path} is a partition, expected a whole disk: /dev/{whole}")
    parts = [folder, *sorted(each for each in folder.glob(f"{name}*") if (each / "partition").exists())]
    numbers = {_read(part / "dev"): part.name for part in parts}
    places = {number: where for number, where in _mounts(processes) if number in numbers}
    mounted = [f"/dev/{numbers[number]} at {where}" for number, where in places.items()]
    if any(where in ("/", "/boot", "/boot/firmware", "/usr") for where in places.values()):
        raise _refuse(f"{path} holds this computer's own system ({mounted[0]}), expected a card or stick")
    if mounted:
        devices = " ".join(f"/dev/{numbers[number]}" for number in places)
        raise _refuse(
            f"{path} is mounted ({', '.join(mounted)}), expected an unmounted one", f"run: sudo umount {devices}"
        )
    for part in parts:
        holders = sorted(each.name for each in (part / "holders").glob("*"))
        if holders or f"/dev/{part.name} " in _read(processes / "swaps") + " ":
            raise _refuse(f"/dev/{part.name} is in use by this computer ({', '.join(holders) or 'swap'})")
    size = int(_read(folder / "size") or 0) * 512
    if not size:
        raise _refuse(f"{path} is empty, expected a card in it")
    if not os.access(path, os.R_OK | os.W_OK):
        raise _refuse(f"{path} may not be written by you", f'run: sudo chown "$USER" {path} (until it is taken out)')
    try:
        os.close(os.open(path, os.O_RDONLY | os.O_EXCL))  # of a block device: fails while the kernel uses any of it
    except OSError as problem:
        raise _refuse(f"{path} cannot be opened: {(problem.strerror or str(problem)).lower()}") from None
    model = " ".join(
        f"{_read(folder / 'device/vendor')} {_read(folder / 'device/model') or _read(folder / 'device/name')}".split()
    )
    return DiskDevice(path, model or "no model name", size)


def _mounts(processes: Path) -> list[tuple[str, str]]:
    rows = [line.split() for line in _read(processes / "self/mountinfo").splitlines()]
    return [(row[2], row[4].replace("\\040", " ")) for row in rows if len(row) > 4]


def _read(path: Path) -> str:
    try:
        return path.read_text(errors="replace").strip()
    except OSError:
        return ""


def _refuse(message: str, help: str | None = None) -> UserError:
    return UserError(error(message, rule="bad-device", help=help))
