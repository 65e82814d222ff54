"""Debuggers, terminals and core dumps on this computer, for the decisions of `ur.run.debugger.choice`."""

from __future__ import annotations

import glob
import importlib.util
import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from ur.run.debugger.attach import DebuggedNode
from ur.run.debugger.choice import DebugTarget, DebugTools, find_kind
from ur.run.debugger.core_dump import CoreRules, belongs_to, explain_no_core, plan_search

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
