"""Debuggers and terminals on this computer, for the decisions of `ur.run.debugger.choice`."""

import importlib.util
import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from ur.run.debugger.choice import DebuggedNode, DebugTarget, DebugTools, find_kind

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


def read_node_facts(name: str, program: str, pid: int | None) -> DebuggedNode:
    """Collect facts about a node: its process, if any, and its executable.

    Raises PermissionError when the process belongs to another user.
    """
    target = read_target(name, program)
    if pid is not None:
        try:
            return DebuggedNode(target, pid, os.readlink(f"/proc/{pid}/exe"))  # noqa: PTH115 - a magic link
        except FileNotFoundError:
            pass  # the process has just ended
    return DebuggedNode(target)


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


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding="ascii")
    except OSError:
        return ""
