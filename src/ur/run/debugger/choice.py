"""Selection of a debugger and its terminal, for a node that starts and for one that runs. Pure."""

from dataclasses import dataclass
from typing import Literal

from ur.source.diagnostic import user_error
from ur.system.debian_root import install_command

Tool = Literal["pudb", "gdb", "debugpy"]
Kind = Literal["python", "module", "binary", "script"]
DebugTerminal = Literal["here", "window", "log"]
TOOLS: tuple[Tool, ...] = ("pudb", "gdb", "debugpy")
PACKAGES = {"gdb": "gdb", "pudb": "python3-pudb", "debugpy": "python3-debugpy", "xterm": "xterm"}
_RUN = ("-q", "-ex", "set breakpoint pending on", "-ex", "run", "--args")
_TRACE = ("-q", "-batch", "-ex", "run", "-ex", "thread apply all backtrace", "--args")


@dataclass(frozen=True, slots=True)
class DebugTools:
    """Debugging tools and terminals on this computer. `installed` are names of PACKAGES.

    `display`: windows open here. `may_attach`: the user may trace other processes than its children (or is root).
    """

    terminal: bool = False
    display: bool = False
    installed: frozenset[str] = frozenset()
    may_attach: bool = True


@dataclass(frozen=True, slots=True)
class DebugTarget:
    """A node to debug. `module`: a shell script of this project that runs one of its Python modules.

    `interpreter` is that of a `python` node.
    """

    name: str
    kind: Kind
    interpreter: str = "python3"


@dataclass(frozen=True, slots=True)
class Debugging:
    """The prefix of a node's command, the terminal of its debugger, and notes for the user."""

    prefix: tuple[str, ...]
    terminal: DebugTerminal
    notes: tuple[str, ...] = ()


def find_kind(head: bytes) -> tuple[Kind, str]:
    """Determine a program's kind from its first bytes (4 kB are enough), and its interpreter if that is Python."""
    if head.startswith(b"\x7fELF"):
        return "binary", ""
    first = head.partition(b"\n")[0].decode("utf-8", "replace")
    if not first.startswith("#!"):
        return "script", ""
    tokens = first[2:].split()
    if tokens and tokens[0].endswith("/env"):
        tokens = [word for word in tokens[1:] if not word.startswith("-") and "=" not in word]
    if tokens and tokens[0].rpartition("/")[2].startswith("python"):
        return "python", tokens[0]
    return ("module", "") if b"lib/node" in head else ("script", "")


def choose_tool(kind: Kind) -> Tool:
    """Return the default debugger for a kind of program."""
    return "gdb" if kind == "binary" else "pudb"


def plan_debugging(target: DebugTarget, tool: Tool, tools: DebugTools, port: int) -> Debugging:
    """Plan the start of a node under a debugger.

    `port` is a free port. Raises UserError, with a remedy, if impossible.
    """
    _check_kind(target, tool)
    _check_installed(target.name, tool, tools)
    if tool == "debugpy":
        options = ("-m", "debugpy", "--listen", f"localhost:{port}", "--wait-for-client")
        notes = (
            f"{target.name} waits for a debugger on localhost:{port}",
            f'  VS Code, launch.json: {{"type": "debugpy", "request": "attach", "connect": {{"port": {port}}}}}',
            f"  from another computer, first: ssh -L {port}:localhost:{port} HOST",
        )
        return Debugging(python_prefix(target, options), "log", notes)
    terminal = choose_terminal(tools)
    if tool == "gdb":
        return _plan_gdb(target, tools, terminal)
    if terminal == "log":
        raise user_error(
            f"--debug {target.name}=pudb: pudb needs a terminal, and there is no terminal or display here",
            rule="no-place-to-debug",
            help=f"--debug {target.name}=debugpy waits for a debugger elsewhere",
            subject=target.name,
        )
    return _run_in_terminal(target.name, python_prefix(target, ("-m", "pudb")), terminal, tools)


def choose_terminal(tools: DebugTools) -> DebugTerminal:
    """Choose the terminal of a debugger: a window, or this terminal; else its output goes to the log only."""
    if tools.display and "xterm" in tools.installed:
        return "window"
    return "here" if tools.terminal else "log"


def python_prefix(target: DebugTarget, options: tuple[str, ...]) -> tuple[str, ...]:
    """Return the arguments before a Python program that set these options of its interpreter."""
    if target.kind == "module":
        return ("env", f"UR_NODE_PYTHON_OPTIONS={' '.join(options)}")
    return (target.interpreter, *options)


def _plan_gdb(target: DebugTarget, tools: DebugTools, terminal: DebugTerminal) -> Debugging:
    if terminal == "log":
        notes = (f"{target.name} runs in gdb; where it crashes, the log will have a backtrace of every thread",)
        program = (target.interpreter,) if target.kind == "python" else ()
        return Debugging(("gdb", *_TRACE, *program), terminal, notes)
    return _run_in_terminal(
        target.name, ("gdb", *_RUN, *((target.interpreter,) if target.kind == "python" else ())), terminal, tools
    )


def _run_in_terminal(name: str, argv: tuple[str, ...], terminal: DebugTerminal, tools: DebugTools) -> Debugging:
    if terminal == "window":
        return Debugging(("xterm", "-T", name, "-e", *argv), terminal, (f"{name} is debugged in a window of its own",))
    notes = [f"{name} is debugged in this terminal; the run ends with it"]
    if tools.display:
        notes.append("with package xterm installed it would have a window of its own: sudo apt-get install xterm")
    return Debugging(argv, terminal, tuple(notes))


def _check_kind(target: DebugTarget, tool: Tool) -> None:
    if tool == "gdb" and target.kind in ("binary", "python"):
        return
    if tool != "gdb" and target.kind in ("python", "module"):
        return
    what = {"binary": "a compiled program", "script": "a shell script", "module": "a script", "python": "Python"}
    expected = "a compiled program or a Python script" if tool == "gdb" else "a Python program"
    other = {"binary": "=gdb", "module": "=pudb"}.get(target.kind)
    raise user_error(
        f"--debug {target.name}={tool}: {target.name} is {what[target.kind]}, expected {expected}",
        rule="wrong-debugger",
        help=f"--debug {target.name}{other}" if other else f"--prefix '{target.name}=bash -x' shows what it does",
        subject=target.name,
    )


def _check_installed(name: str, tool: Tool, tools: DebugTools) -> None:
    if tool in tools.installed:
        return
    raise user_error(
        f"--debug {name}={tool}: {tool} is not installed",
        rule="no-debugger",
        help=install_command(PACKAGES[tool]),
        subject=name,
    )


@dataclass(frozen=True, slots=True)
class DebuggedNode:
    """A node, and the executable of its process ('' without a process)."""

    target: DebugTarget
    pid: int | None = None
    process: str = ""

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
    """Choose gdb on a running program; return the reason as text if it cannot be."""
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
    if facts.pid is None:
        return f"{name} does not run: ur launch --debug {name} ... starts it in gdb; coredumpctl opens its core file"
    argv = (*(() if tools.may_attach else ("sudo",)), "gdb", "-q", "-p", str(facts.pid))
    if terminal == "window":
        return DebuggerCommand(("xterm", "-T", name, "-e", *argv), here=False)
    return DebuggerCommand(argv, here=True)


def _is_shell(path: str) -> bool:
    return path.rpartition("/")[2] in ("bash", "sh", "dash", "zsh", "ash", "busybox")
