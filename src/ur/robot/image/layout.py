"""The operating system of an image, and the location of its first-boot seed, found by content.

Sources: cloud-init's data source NoCloud (cloudinit/sources/DataSourceNoCloud.py), Ubuntu's README on system-boot,
Raspberry Pi OS: pi-gen (stage2/04-cloud-init) and raspberrypi-sys-mods (firstboot, init_config, sshswitch).
"""

import re
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Literal

from ur.robot.image.device import Partition, Read, read_partitions
from ur.robot.image.volume import ExtVolume, FatVolume, Volume, unfinished_names
from ur.source.diagnostic import UserError, user_error
from ur.system.releases import System, parse_os_release

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


SEED_FOLDER = "var/lib/cloud/seed/nocloud"
_FIRST_BOOT = "init=/usr/lib/raspberrypi-sys-mods/firstboot"
_EXPECTED = "expected an image of Ubuntu (Raspberry Pi or cloud), Debian (cloud) or Raspberry Pi OS"


class Scheme(Enum):
    """The first-boot configuration scheme of an operating system."""

    BOOT_SEED = "cloud-init reads a seed from the boot partition"
    ROOT_SEED = "cloud-init reads a seed from a folder of the system"
    CUSTOM_TOML = "Raspberry Pi OS 12 reads custom.toml from the boot partition"


@dataclass(frozen=True, slots=True)
class Layout:
    """The content of an image.

    `boot` or `root` is None if the scheme does not need it. `system` is the name that the system gives itself,
    `raspberry` whether it is Raspberry Pi OS, `netplan` the version of netplan ('' if unknown). `os` is None if the
    system cannot be read.
    """

    scheme: Scheme
    system: str
    boot: Volume | None
    root: Volume | None
    raspberry: bool = False
    netplan: str = ""
    os: System | None = None


@contextmanager
def open_reader(path: Path) -> Iterator[tuple[Read, int]]:
    """Open a file or device; yield a function that reads bytes of it, and its size.

    Raises UserError without its name.
    """
    try:
        with path.open("rb") as file:
            size = file.seek(0, 2)

            def read(offset: int, count: int) -> bytes:
                file.seek(offset)
                return file.read(count)

            yield read, size
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise user_error(f"cannot be read: {reason}", rule="unreadable-file") from None


def find_layout(path: Path) -> Layout:
    """Read an image or device. Raises UserError for one of an unknown kind, with a description of its content."""
    try:
        return _find_layout(path)
    except UserError as problem:
        raise UserError(*(each._replace(message=f"{path}: {each.message}") for each in problem.diagnostics)) from None


def _find_layout(path: Path) -> Layout:
    with open_reader(path) as (read, size):
        partitions = read_partitions(read, size)
        systems = [(each, identify_filesystem(read, each.start)) for each in partitions]
        if not partitions:
            whole = identify_filesystem(read, 0)
            if whole.kind == "unknown":
                raise _unknown(describe_other(read))
            systems = [(Partition(0, 0, size), whole)]
    fats = [(FatVolume(path, where.start), what) for where, what in systems if what.kind == "fat"]
    roots = [(ExtVolume(path, where.start), what) for where, what in systems if what.kind == "ext"]
    root = next(((volume, what) for volume, what in roots if volume.read("etc/os-release") or _os(volume)), None)
    for boot, what in fats:
        if found := _boot_layout(boot, what, *(root or (None, None))):
            return found
    if root and root[0].read("etc/cloud/cloud.cfg") is not None:
        if root[1].dirty:
            raise _dirty()
        system = _name(root[0])
        return Layout(Scheme.ROOT_SEED, system, None, root[0], netplan=_netplan(root[0]), os=_system(root[0]))
    raise _unknown(_describe(systems, root[0] if root else None))


def _boot_layout(
    boot: FatVolume, what: FileSystem, root: ExtVolume | None, root_is: FileSystem | None
) -> Layout | None:
    names = boot.names()
    raspberry = "issue.txt" in names or what.label == "bootfs"
    if {"user-data", "meta-data"} <= unfinished_names(names) or what.label.lower() == "cidata":
        name = _name(root) if root else "a system with cloud-init"
        netplan, system = (_netplan(root), _system(root)) if root else ("", None)
        return Layout(Scheme.BOOT_SEED, name, boot, root, raspberry=raspberry, netplan=netplan, os=system)
    command = boot.read("cmdline.txt")
    if command is None or not raspberry:
        return None
    if _FIRST_BOOT.encode() not in command or root is None:
        which = _name(root) if root else "without a system partition"
        raise user_error(
            f"Raspberry Pi OS ({which}), without cloud-init or booted before, expected one with user-data "
            "on its boot partition (13, since November 2025) or a fresh 12",
            rule="unknown-image",
            help="take a newer image, or flash it again",
        )
    if root_is and root_is.dirty:
        raise _dirty()
    return Layout(Scheme.CUSTOM_TOML, _name(root), boot, root, raspberry=True, os=_system(root))


def _os(root: ExtVolume) -> bytes | None:
    return root.read("usr/lib/os-release")


def _name(root: ExtVolume) -> str:
    text = (_os(root) or b"").decode(errors="replace")
    found = re.search(r'^PRETTY_NAME="?([^"\n]*)', text, re.MULTILINE)
    return found[1] if found else "a Linux system"


def _system(root: ExtVolume) -> System | None:
    text = _os(root)
    return None if text is None else parse_os_release(text.decode(errors="replace"))


def _netplan(root: ExtVolume) -> str:
    text = (root.read("var/lib/dpkg/status") or b"").decode(errors="replace")
    found = re.search(r"^Package: netplan\.io\n(?:\S.*\n| .*\n)*?Version: (\S+)", text, re.MULTILINE)
    return found[1] if found else ""


def _describe(systems: list[tuple[Partition, FileSystem]], root: ExtVolume | None) -> str:
    if root:
        return f"{_name(root)} without cloud-init"
    kinds = ", ".join(f"{where.number}: {what.kind}{' ' + what.label if what.label else ''}" for where, what in systems)
    return f"a disk with partitions of another system ({kinds})"


def _dirty() -> UserError:
    return user_error(
        "its file system was not unmounted when it was last used, expected a clean one",
        rule="damaged-image",
        help="flash it again, or boot it and shut it down",
    )


def _unknown(what: str) -> UserError:
    help = None
    if "qcow2" in what:
        help = "run: qemu-img convert -O raw IMAGE IMAGE.raw (package qemu-utils), then prepare IMAGE.raw"
    return user_error(f"{what}, {_EXPECTED}", rule="unknown-image", help=help)
