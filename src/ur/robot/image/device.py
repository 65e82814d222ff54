"""Devices with a flashed system: whether they may be written to; partitions (MBR and GPT) of disks and images."""

import os
import stat
import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from ur.source.diagnostic import UserError, user_error


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
    return user_error(message, rule="bad-device", help=help)


# A function (offset, count) that reads bytes. It returns fewer at the end of the disk.
Read = Callable[[int, int], bytes]
SECTOR = 512
_EXTENDED = (0x05, 0x0F, 0x85)
_PROTECTIVE = 0xEE
_LOGICAL_LIMIT = 60


@dataclass(frozen=True, slots=True)
class Partition:
    """A range of a disk: its number as in the kernel's names (0: the whole disk), first byte and length in bytes."""

    number: int
    start: int
    size: int


def read_partitions(read: Read, size: int) -> tuple[Partition, ...]:
    """Return the partitions of a disk of `size` bytes, by number; empty without a partition table.

    Raises UserError for a table that is damaged, or that exceeds the disk.
    """
    first = read(0, SECTOR)
    if len(first) < SECTOR or first[510:512] != b"\x55\xaa":
        return ()
    entries = [_parse_entry(first, slot) for slot in range(4)]
    if any(entry.status not in (0x00, 0x80) for entry in entries):
        return ()  # the boot sector of a file system ends with the same signature
    found = _read_gpt(read) if any(entry.kind == _PROTECTIVE for entry in entries) else list(_read_mbr(read, entries))
    for partition in found:
        if partition.start + partition.size > size:
            raise _bad(
                f"it ends ({size} bytes) before its partition {partition.number} does "
                f"({partition.start + partition.size} bytes), expected a whole image"
            )
    return tuple(sorted(found, key=lambda partition: partition.number))


@dataclass(frozen=True, slots=True)
class _Entry:
    status: int
    kind: int
    start: int
    sectors: int


def _parse_entry(sector: bytes, slot: int) -> _Entry:
    status, kind, start, sectors = struct.unpack_from("<B3xB3xII", sector, 446 + 16 * slot)
    return _Entry(status, kind, start, sectors)


def _read_mbr(read: Read, entries: list[_Entry]) -> Iterator[Partition]:
    for number, entry in enumerate(entries, start=1):
        if entry.kind in _EXTENDED and entry.sectors:
            yield from _read_logical(read, entry.start)
        elif entry.kind and entry.sectors:
            yield Partition(number, entry.start * SECTOR, entry.sectors * SECTOR)


def _read_logical(read: Read, base: int) -> Iterator[Partition]:
    record = base
    for number in range(5, 5 + _LOGICAL_LIMIT):
        sector = read(record * SECTOR, SECTOR)
        if len(sector) < SECTOR or sector[510:512] != b"\x55\xaa":
            raise _bad("its extended partition table is damaged, expected a boot record with a signature")
        here, following = _parse_entry(sector, 0), _parse_entry(sector, 1)
        if here.kind and here.sectors:
            yield Partition(number, (record + here.start) * SECTOR, here.sectors * SECTOR)
        if following.kind not in _EXTENDED or not following.sectors:
            return
        record = base + following.start


def _read_gpt(read: Read) -> list[Partition]:
    for sector in (512, 4096):
        header = read(sector, 92)
        if header[:8] == b"EFI PART" and len(header) == 92:
            break
    else:
        raise _bad("its partition table (GPT) has no header, expected one behind the protective MBR")
    length, checksum = struct.unpack_from("<II", header, 12)
    table, count, entry_size, table_checksum = struct.unpack_from("<QIII", header, 72)
    if not 92 <= length <= sector or not 128 <= entry_size <= 4096 or not 0 < count <= 1024:
        raise _bad("its partition table (GPT) is damaged, expected a header that makes sense")
    whole = read(sector, length)
    entries = read(table * sector, count * entry_size)
    sums = (zlib.crc32(whole[:16] + bytes(4) + whole[20:]), zlib.crc32(entries))
    if sums != (checksum, table_checksum):
        raise _bad("its partition table (GPT) is damaged: a checksum is wrong")
    found = []
    for slot in range(count):
        kind, first, last = struct.unpack_from("<16s16xQQ", entries, slot * entry_size)
        if kind != bytes(16) and last >= first:
            found.append(Partition(slot + 1, first * sector, (last + 1 - first) * sector))
    return found


def _bad(message: str) -> UserError:
    return user_error(message, rule="damaged-image", help="download and flash it again")
