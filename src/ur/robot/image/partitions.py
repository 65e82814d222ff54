"""Partitions of a disk or of its image: MBR and GPT, read without root and without a device for it.

Sources: UEFI specification 2.10, chapter 5 (GPT, and the protective MBR); for logical partitions, the chain of extended
boot records as Linux reads it (block/partitions/msdos.c).
"""

import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ur.source.diagnostic import UserError, error

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
                f"({partition.start + partition.size} bytes), expected a whole image",
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
    return UserError(error(message, rule="damaged-image", help="download and flash it again"))
