"""Methods to debug a running or ended node from outside its run. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from ur.run.debugger.choice import (
    PACKAGES,
    DebugTarget,
    DebugTerminal,
    DebugTools,
    choose_terminal,
    gdb_prefix,
    python_prefix,
)
from ur.system.debian_root import install_command


@dataclass(frozen=True, slots=True)
class DebuggedNode:
    """Facts about a node.

    `program` is its executable, `process` the executable of its process ('' without a process). `core_dump` is the
    command that opens its core file in gdb; if it is empty, `no_core_dump` is the reason.
    """

    target: DebugTarget
    program: str
    pid: int | None = None
    process: str = ""
    core_dump: tuple[str, ...] = ()
    no_core_dump: str = ""

    @property
    def python(self) -> bool:
        """Return whether the node is, or would be, run by Python."""
        if self.process:
            return self.process.rpartition("/")[2].startswith("python")
        return self.target.kind in ("python", "module")


@dataclass(frozen=True, slots=True)
class DebugMethod:
    """One method to debug a node: its key, its label, and its command.

    `here`: the command occupies this terminal. `prefix`: the node is restarted with this prefix instead.
    """

    key: str
    text: str
    command: tuple[str, ...]
    here: bool
    prefix: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class DebugMethods:
    """Methods to debug a node, best first, and a note for the user who chooses."""

    methods: tuple[DebugMethod, ...]
    note: str = ""


def list_debug_methods(facts: DebuggedNode, tools: DebugTools) -> DebugMethods | str:
    """List the methods to debug a node, best first; return the reason as text if there is none.

    A node is restarted in a window only: this terminal is not the run's.
    """
    name = facts.target.name
    running = facts.pid is not None
    if facts.process and not facts.python and _is_shell(facts.process):
        return f"{name} is a shell script: ur launch --prefix '{name}=bash -x' ... shows what it does"
    if not facts.process and facts.target.kind == "script":
        return f"{name} is a script that does not run now: start it, then debug it"
    terminal = choose_terminal(tools)
    if terminal == "log":
        return f"there is no terminal here to debug {name} in"
    tool = "pudb" if facts.python else "gdb"
    if tool not in tools.installed:
        return f"{tool}, which debugs {name}, is not installed: {install_command(PACKAGES[tool])}"
    windows = f"no window opens here: ur launch --debug {name} ... runs it in {tool} from its start"
    if facts.python:
        if terminal == "here":
            return windows
        again = "start it again in pudb" if running else "start it in pudb"
        method = _start_again(facts, "p", again, python_prefix(facts.target, ("-m", "pudb")), tools)
        return DebugMethods((method,), "what it knows now is lost" if running else "")
    if running:
        root = () if tools.may_attach else ("sudo",)
        argv = (*root, "gdb", "-q", "-p", str(facts.pid))
        return DebugMethods((_open("g", "gdb", argv, name, terminal),))
    methods = []
    if facts.core_dump:
        methods.append(_open("c", "look at its core file: where it crashed", facts.core_dump, name, terminal))
    if terminal == "window":
        methods.append(_start_again(facts, "g", "start it again in gdb", gdb_prefix(facts.target), tools))
    return DebugMethods(tuple(methods), facts.no_core_dump) if methods else f"{facts.no_core_dump}; {windows}"


def _start_again(facts: DebuggedNode, key: str, text: str, tool: tuple[str, ...], tools: DebugTools) -> DebugMethod:
    window = ("env", f"DISPLAY={tools.display}", "xterm", "-T", facts.target.name, "-e", *tool)  # the run may have none
    return DebugMethod(key, text, (), False, window)


def _open(key: str, text: str, argv: tuple[str, ...], name: str, terminal: DebugTerminal) -> DebugMethod:
    if terminal == "window":
        return DebugMethod(key, text, ("xterm", "-T", name, "-e", *argv), here=False)
    return DebugMethod(key, text, argv, here=True)


def _is_shell(path: str) -> bool:
    return path.rpartition("/")[2] in ("bash", "sh", "dash", "zsh", "ash", "busybox")
