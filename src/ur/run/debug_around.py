"""What there is to debug with on this computer: looked up, then decided upon by `ur.run.debug`."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from ur.run import debug_pane
from ur.run.debug import Surroundings, Target, find_kind

_PTRACE_SCOPE = "/proc/sys/kernel/yama/ptrace_scope"  # 0: any process of the same user, ptrace(2)


def look_around(environment: Mapping[str, str], *, terminal: bool, python: str = "") -> Surroundings:
    """What is there. `python` is the interpreter whose modules count, '' for that of this project."""
    path = environment.get("PATH")
    tools = {name for name in ("gdb", "xterm") if shutil.which(name, path=path)}
    asked = python or sys.executable
    tools |= {name for name in ("pudb", "debugpy") if _has_module(asked, name)}
    return Surroundings(
        terminal=terminal,
        tmux=bool(environment.get("TMUX")) and shutil.which("tmux", path=path) is not None,
        display=bool(environment.get("DISPLAY")),
        tools=frozenset(tools),
        may_attach=os.geteuid() == 0 or _read(_PTRACE_SCOPE).strip() in ("", "0"),
        python=sys.executable,
        pane_program=debug_pane.__file__,
    )


def look_at_program(name: str, path: str) -> Target:
    """What kind of program a node is."""
    try:
        with Path(path).open("rb") as file:
            kind, interpreter = find_kind(file.read(4096))
    except OSError:
        kind, interpreter = "script", ""
    return Target(name, kind, interpreter or "python3")


def find_free_port(first: int = 5678) -> int:
    """A port that nobody listens on now, debugpy's usual one first."""
    for port in (first, 0):
        with socket.socket() as probe:
            try:
                probe.bind(("localhost", port))
            except OSError:
                continue
            found: int = probe.getsockname()[1]
            return found
    return first


def _has_module(python: str, name: str) -> bool:
    words = [python, "-c", f"import importlib.util as u; raise SystemExit(u.find_spec({name!r}) is None)"]
    try:
        return (
            subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, timeout=10, check=False).returncode
            == 0
        )
    except (OSError, subprocess.TimeoutExpired):
        return False


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding="ascii")
    except OSError:
        return ""
