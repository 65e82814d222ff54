"""Methods to debug a node that runs, or ran, from outside its run. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from ur.debian.root import install_command
from ur.run.debugger.choice import PACKAGES, Surroundings, Target, choose_place, gdb_words, python_words


@dataclass(frozen=True, slots=True)
class Looked:
    """Facts about a node. `program` is its executable, `process` the one that its process runs ('' when there is none).

    `core` are the arguments after gdb (or before, for coredumpctl) to open its core file; else `no_core` is the reason.
    """

    target: Target
    program: str
    pid: int | None = None
    process: str = ""
    core: tuple[str, ...] = ()
    no_core: str = ""

    @property
    def python(self) -> bool:
        """True for a node that Python runs, or would run."""
        if self.process:
            return self.process.rpartition("/")[2].startswith("python")
        return self.target.kind in ("python", "module")


@dataclass(frozen=True, slots=True)
class Way:
    """One method to debug a node: its key, its label, and its command.

    `here`: the command needs this terminal meanwhile. `prefix`: the node is started again with this in front.
    """

    key: str
    text: str
    command: tuple[str, ...]
    here: bool
    prefix: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Ways:
    """Methods to debug a node, best first, and a note for the person who chooses."""

    ways: tuple[Way, ...]
    note: str = ""


def plan_looking(looked: Looked, around: Surroundings, address: str) -> Ways | str:
    """List the methods to debug a node, best first; return an explanation as text where there is none.

    `address` is where a new Unix socket may be made, for a node that is started again.
    """
    name = looked.target.name
    running = looked.pid is not None
    if looked.process and not looked.python and _is_shell(looked.process):
        return f"{name} is a shell script: ur launch --prefix '{name}=bash -x' ... shows what it does"
    if not looked.process and looked.target.kind == "script":
        return f"{name} is a script that does not run now: start it, then debug it"
    if choose_place(around) == "log":
        return f"there is no terminal here to debug {name} in"
    tool = "pudb" if looked.python else "gdb"
    if tool not in around.tools:
        return f"{tool}, which debugs {name}, is not installed: {install_command(PACKAGES[tool])}"
    if looked.python:
        again = "start it again in pudb" if running else "start it in pudb"
        way = _start_again(looked, "p", again, python_words(looked.target, ("-m", "pudb")), around, address)
        return Ways((way,), "what it knows now is lost" if running else "")
    if running:
        root = () if around.may_attach else ("sudo",)
        pane = (around.python, "-I", around.pane_program)
        words = (*pane, "--attach", str(looked.pid), *root, "gdb", "-q", "-p", str(looked.pid))
        return Ways((_open("g", "gdb", words, name, around),))
    ways = [_open("c", "look at its core file: where it crashed", looked.core, name, around)] if looked.core else []
    ways.append(_start_again(looked, "g", "start it again in gdb", gdb_words(looked.target), around, address))
    return Ways(tuple(ways), looked.no_core)


def _start_again(looked: Looked, key: str, text: str, tool: tuple[str, ...], around: Surroundings, address: str) -> Way:
    name = looked.target.name
    pane = (around.python, "-I", around.pane_program)
    way = _open(key, text, (*pane, "--wait", address, name), name, around)
    return Way(key, text, way.command, way.here, (*pane, "--join", address, name, *tool))


def _open(key: str, text: str, words: tuple[str, ...], name: str, around: Surroundings) -> Way:
    place = choose_place(around)
    if place == "pane":
        return Way(key, text, ("tmux", "split-window", "-h", *words), here=False)
    if place == "window":
        return Way(key, text, ("xterm", "-T", name, "-e", *words), here=False)
    return Way(key, text, words, here=True)


def _is_shell(path: str) -> bool:
    return path.rpartition("/")[2] in ("bash", "sh", "dash", "zsh", "ash", "busybox")
