"""Debuggers, terminals and core dumps on this computer, for the decisions of `ur.run.debugger.choice`."""

import glob
import importlib.util
import os
import re
import shutil
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ur.run.debugger.attach import DebuggedNode
from ur.run.debugger.choice import DebugTarget, DebugTools, find_kind

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


_USES_PID = "/proc/sys/kernel/core_uses_pid"
_HEAD = 1 << 20  # bytes of a core file: its notes come first
_PTRACE_SCOPE = "/proc/sys/kernel/yama/ptrace_scope"  # 0: any process of the same user, ptrace(2)


def find_debug_tools(environment: Mapping[str, str], *, terminal: bool, python: str = "") -> DebugTools:
    """Find debugging tools and terminals.

    `python` is the interpreter whose modules are searched; '': that of this project.
    """
    path = environment.get("PATH")
    tools = {name for name in ("gdb", "xterm") if shutil.which(name, path=path)}
    tools |= _find_modules(python or sys.executable, ("pudb", "debugpy"))
    return DebugTools(
        terminal=terminal,
        display=bool(environment.get("DISPLAY")),
        installed=frozenset(tools),
        may_attach=os.geteuid() == 0 or _read(_PTRACE_SCOPE).strip() in ("", "0"),
    )


def read_target(name: str, path: str) -> DebugTarget:
    """Read the kind of a node's program."""
    try:
        with Path(path).open("rb") as file:
            kind, interpreter = find_kind(file.read(4096))
    except OSError:
        kind, interpreter = "script", ""
    return DebugTarget(name, kind, interpreter or "python3")


def read_node_facts(name: str, program: str, folder: str, pid: int | None, run_pid: int) -> DebuggedNode:
    """Collect facts about a node: its process, if any, its executable, and the core file of a crash.

    `folder` is its working directory, `run_pid` the supervisor, whose limits nodes inherit. Raises PermissionError when
    the process belongs to another user.
    """
    target = read_target(name, program)
    if pid is not None:
        try:
            return DebuggedNode(target, program, pid, os.readlink(f"/proc/{pid}/exe"))  # noqa: PTH115 - a magic link
        except FileNotFoundError:
            pass  # the process has just ended
    if target.kind != "binary":
        return DebuggedNode(target, program)
    core, why = find_core_dump(os.path.realpath(program), folder, read_core_rules(run_pid))
    return DebuggedNode(target, program, None, "", core, why)


def read_core_rules(pid: int) -> CoreRules:
    """Read the system's settings for core files of a process and its children."""
    limit: int | None = None
    for line in _read(f"/proc/{pid}/limits").splitlines():
        if line.startswith("Max core file size"):
            soft = line.split()[4]
            limit = int(soft) if soft.isdigit() else None
    return CoreRules(_read("/proc/sys/kernel/core_pattern"), _read(_USES_PID).strip() == "1", limit)


def find_core_dump(program: str, folder: str, rules: CoreRules) -> tuple[tuple[str, ...], str]:
    """Return the command that opens the newest core file of a program (real path) in gdb; else () and the reason."""
    names = plan_search(rules, program, folder)
    if names.keeper == "coredumpctl":
        if _coredumpctl_has(program):
            return ("coredumpctl", "debug", program), ""
        return (), explain_no_core(rules, names, folder)
    found = [path for pattern in names.patterns for path in glob.glob(pattern)]  # noqa: PTH207 - absolute patterns
    for path in sorted(found, key=_age):
        if belongs_to(_read_head(path), program):
            return ("gdb", "-q", program, path), ""
    return (), explain_no_core(rules, names, folder)


def find_free_port(first: int = 5678) -> int:
    """Find a port on which no program listens now, trying debugpy's default port first."""
    for port in (first, 0):
        with socket.socket() as probe:
            try:
                probe.bind(("localhost", port))
            except OSError:
                continue
            found: int = probe.getsockname()[1]
            return found
    return first


def _find_modules(python: str, names: tuple[str, ...]) -> set[str]:
    """Return the modules, of these, that an interpreter has; this project's interpreter is not started for that."""
    if python == sys.executable:
        return {name for name in names if importlib.util.find_spec(name) is not None}
    argv = [python, "-c", f"import importlib.util as u; print(*(n for n in {names!r} if u.find_spec(n)))"]
    try:
        done = subprocess.run(  # in the root folder, since the interpreter would import modules of the current one
            argv, stdin=subprocess.DEVNULL, capture_output=True, timeout=20, check=False, text=True, cwd="/"
        )
    except (OSError, subprocess.TimeoutExpired):
        return set()
    return set(done.stdout.split())


def _coredumpctl_has(program: str) -> bool:
    argv = ["coredumpctl", "--no-pager", "-q", "list", program]
    try:
        done = subprocess.run(argv, stdin=subprocess.DEVNULL, capture_output=True, timeout=20, check=False, text=True)
    except (OSError, subprocess.TimeoutExpired):
        return False
    last = done.stdout.strip().splitlines()[-1:]
    return bool(last) and " present" in last[0]


def _age(path: str) -> float:
    try:
        return -os.stat(path).st_mtime  # noqa: PTH116 - glob gives texts
    except OSError:
        return 0.0


def _read_head(path: str) -> bytes:
    try:
        with open(path, "rb") as file:  # noqa: PTH123 - glob gives texts
            return file.read(_HEAD)
    except OSError:
        return b""


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding="ascii")
    except OSError:
        return ""
