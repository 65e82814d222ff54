"""The debugger of a running or crashed node, from outside its run. Pure."""

from dataclasses import dataclass

from ur.run.debugger.choice import PACKAGES, DebugTarget, DebugTools, choose_terminal
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
class DebuggerCommand:
    """The command of a debugger. `here`: it occupies this terminal, and opens no window."""

    argv: tuple[str, ...]
    here: bool


def choose_debugger(facts: DebuggedNode, tools: DebugTools) -> DebuggerCommand | str:
    """Choose gdb on a running program, or on the core file of a crash; return the reason as text if neither can be."""
    name = facts.target.name
    if facts.process and not facts.python and _is_shell(facts.process):
        return f"{name} is a shell script: ur launch --prefix '{name}=bash -x' ... shows what it does"
    if not facts.process and facts.target.kind == "script":
        return f"{name} is a script that does not run now: start it, then debug it"
    if facts.python:
        return f"{name} is Python: ur launch --debug {name} ... starts it in pudb"
    terminal = choose_terminal(tools)
    if terminal == "log":
        return f"there is no terminal here to debug {name} in"
    if "gdb" not in tools.installed:
        return f"gdb, which debugs {name}, is not installed: {install_command(PACKAGES['gdb'])}"
    root = () if tools.may_attach else ("sudo",)
    argv = facts.core_dump if facts.pid is None else (*root, "gdb", "-q", "-p", str(facts.pid))
    if not argv:
        return f"{facts.no_core_dump}; ur launch --debug {name} ... starts it in gdb"
    if terminal == "window":
        return DebuggerCommand(("xterm", "-T", name, "-e", *argv), here=False)
    return DebuggerCommand(argv, here=True)


def _is_shell(path: str) -> bool:
    return path.rpartition("/")[2] in ("bash", "sh", "dash", "zsh", "ash", "busybox")
