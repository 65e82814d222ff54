"""Core dumps of crashed programs: their path, or the reason for their absence, core(5).

Pure: `ur.run.debugger.environment` reads the system.
"""

from __future__ import annotations

import glob
import os
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

APPORT = "/var/lib/apport/coredump"  # where Ubuntu's apport keeps the core files that a limit above 0 asks for
Keeper = Literal["file", "coredumpctl", "unknown"]
_NOTE, _FILES, _PRPSINFO = 4, 0x46494C45, 3  # elf.h: PT_NOTE, NT_FILE, NT_PRPSINFO


@dataclass(frozen=True, slots=True)
class CoreRules:
    """The system's settings for core files: `pattern` and `uses_pid` are those of /proc/sys/kernel.

    `limit` is the soft limit for the size of the run's core files in bytes; None: unlimited.
    """

    pattern: str
    uses_pid: bool = False
    limit: int | None = None


@dataclass(frozen=True, slots=True)
class CoreNames:
    """The service that stores core files, and for `file` glob patterns of the paths of one program's core files."""

    keeper: Keeper
    patterns: tuple[str, ...] = ()
    handler: str = ""


def plan_search(rules: CoreRules, program: str, folder: str) -> CoreNames:
    """Determine the service and the possible paths for core files of a program that was started in a folder."""
    pattern = rules.pattern.strip()
    if pattern.startswith("|"):
        handler = pattern[1:].split()[0] if pattern[1:].split() else ""
        if handler.endswith("systemd-coredump"):
            return CoreNames("coredumpctl", handler=handler)
        if handler.endswith("apport"):
            name = glob.escape(program.replace("/", "_"))
            return CoreNames("file", (f"{APPORT}/core.{name}.*",), handler)
        return CoreNames("unknown", handler=handler)
    path = "".join(_expand(pattern or "core", program))
    if rules.uses_pid and "%p" not in pattern:
        path += ".*"
    return CoreNames("file", (path if path.startswith("/") else f"{glob.escape(folder)}/{path}",))


def explain_no_core(rules: CoreRules, names: CoreNames, folder: str) -> str:
    """Explain to the user why a crash left no core file, and how to get one."""
    if rules.limit == 0:
        return "no core file: their size is limited to 0 here; 'ulimit -c unlimited' before ur launch changes that"
    if names.keeper == "unknown":
        return f"no core file: this system hands them to {names.handler} (/proc/sys/kernel/core_pattern)"
    if names.keeper == "coredumpctl":
        return "no core file: coredumpctl has none of it"
    where = os.path.dirname(names.patterns[0])  # noqa: PTH120 - a pattern, not a path
    return f"no core file of it in {where or folder}"


def belongs_to(core: bytes, program: str) -> bool:
    """Return whether the beginning of an ELF core file (its notes: 1 MB suffices) is that of a program (real path)."""
    for kind, body in _iterate_notes(core):
        if kind == _FILES and program.encode() in body.split(b"\0"):
            return True
        if kind == _PRPSINFO and program.encode() in body:
            return True
    return False


def _expand(pattern: str, program: str) -> Iterator[str]:
    known = {
        "%%": "%",
        "%e": glob.escape(program.rpartition("/")[2][:15]),
        "%E": glob.escape(program.replace("/", "!")),
    }
    for piece in re.split("(%.)", pattern):
        yield known.get(piece, "*") if piece.startswith("%") else glob.escape(piece)


def _iterate_notes(core: bytes) -> Iterator[tuple[int, bytes]]:
    if core[:4] != b"\x7fELF" or len(core) < 64:
        return
    order = "<" if core[5] == 1 else ">"
    wide = core[4] == 2
    try:
        start = struct.unpack_from(order + ("Q" if wide else "I"), core, 32 if wide else 28)[0]
        size, count = struct.unpack_from(order + "HH", core, 54 if wide else 42)
        for number in range(count):
            at = start + number * size
            if struct.unpack_from(order + "I", core, at)[0] != _NOTE:
                continue
            place, _, _, length = struct.unpack_from(order + ("4Q" if wide else "4I"), core, at + (8 if wide else 4))
            yield from _split_notes(core[place : place + length], order)
    except (struct.error, OverflowError):  # the file is truncated, or not a core file
        return


def _split_notes(notes: bytes, order: str) -> Iterator[tuple[int, bytes]]:
    at = 0
    while at + 12 <= len(notes):
        name, size, kind = struct.unpack_from(order + "3I", notes, at)
        at += 12 + (name + 3) // 4 * 4
        yield kind, notes[at : at + size]
        at += (size + 3) // 4 * 4
