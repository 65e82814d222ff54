"""Identification of bytes: file systems by their superblocks, other things by their first bytes.

Sources: Microsoft, "FAT: General Overview of On-Disk Format" 1.03; the Linux kernel's documentation of ext4 (super
block); file(1) for the rest.
"""

import struct
from dataclasses import dataclass
from typing import Literal

from ur.robot.image.partitions import Read

_NEEDS_RECOVERY = 0x4
_PACKED = {
    b"\xfd7zXZ\x00": "xz",
    b"\x1f\x8b": "gzip",
    b"BZh": "bzip2",
    b"PK\x03\x04": "zip",
    b"\x28\xb5\x2f\xfd": "zstd",
}
_OTHERS = (
    (0, b"QFI\xfb", "a qcow2 disk of QEMU"),
    (0, b"KDMV", "a VMware disk"),
    (0, b"conectix", "a Virtual PC disk"),
    (0, b"vhdxfile", "a Hyper-V disk"),
    (0, b"\x7fELF", "a program"),
    (0, b"hsqs", "a squashfs file system"),
    (0, b"LUKS", "an encrypted disk"),
    (32769, b"CD001", "an image of a CD or DVD (ISO 9660)"),
)


@dataclass(frozen=True, slots=True)
class FileSystem:
    """A file system: its kind, its label, and whether it was not unmounted cleanly."""

    kind: Literal["fat", "ext", "unknown"]
    label: str = ""
    dirty: bool = False


def identify_filesystem(read: Read, start: int) -> FileSystem:
    """Identify the file system that begins at byte `start`."""
    found = _identify_ext(read(start + 1024, 256)) or _identify_fat(read(start, 512))
    return found or FileSystem("unknown")


def identify_packing(head: bytes) -> str | None:
    """Identify the compression by the first bytes: xz, gzip, bzip2, zip or zstd; None for an uncompressed file."""
    return next((name for mark, name in _PACKED.items() if head.startswith(mark)), None)


def describe_other(read: Read) -> str:
    """Describe a file with neither partitions nor a file system, in a few words."""
    for offset, mark, name in _OTHERS:
        if read(offset, len(mark)) == mark:
            return name
    head = read(0, 4096)
    if not head:
        return "an empty file"
    if b"\x00" not in head:
        return "a text"
    return "an empty disk" if not head.strip(b"\x00") else "something without partitions"


def _identify_ext(block: bytes) -> FileSystem | None:
    if len(block) < 256 or struct.unpack_from("<H", block, 56)[0] != 0xEF53:
        return None
    (incompatible,) = struct.unpack_from("<I", block, 96)
    label = block[120:136].rstrip(b"\x00").decode(errors="replace")
    return FileSystem("ext", label, bool(incompatible & _NEEDS_RECOVERY))


def _identify_fat(sector: bytes) -> FileSystem | None:
    if len(sector) < 512 or sector[510:512] != b"\x55\xaa":
        return None
    bytes_per_sector, per_cluster, reserved, tables = struct.unpack_from("<HBHB", sector, 11)
    plausible = bytes_per_sector in (512, 1024, 2048, 4096) and per_cluster and not per_cluster & (per_cluster - 1)
    if not plausible or not reserved or tables not in (1, 2):
        return None
    for name, label in ((82, 71), (54, 43)):  # FAT32, FAT12 and FAT16
        if sector[name : name + 3] == b"FAT":
            text = sector[label : label + 11].decode("latin-1").rstrip(" \x00")
            return FileSystem("fat", "" if text == "NO NAME" else text)
    return None
