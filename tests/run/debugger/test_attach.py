from __future__ import annotations

from dataclasses import replace

import pytest

from ur.run.debugger.attach import DebuggedNode, DebugMethod, DebugMethods, list_debug_methods
from ur.run.debugger.choice import DebugTarget, DebugTools

ALL = frozenset({"gdb", "pudb", "debugpy", "xterm"})
HERE = DebugTools(terminal=True, installed=ALL, python="/p", pane_program="/pane.py")
TMUX = replace(HERE, tmux=True)
DISPLAY = replace(HERE, display=True)
BINARY = DebuggedNode(DebugTarget("/a", "binary"), "/x/a", 12, "/x/a")
PYTHON = DebuggedNode(DebugTarget("/a", "python", "/usr/bin/python3"), "/x/a", 12, "/usr/bin/python3.11")
MODULE = DebuggedNode(DebugTarget("/a", "module"), "/x/a", 12, "/venv/bin/python3")
ADDRESS = "/tmp/d/join"
WAIT = ("/p", "-I", "/pane.py", "--wait", ADDRESS, "/a")
ATTACH = ("/p", "-I", "/pane.py", "--attach", "12")
JOIN = ("/p", "-I", "/pane.py", "--join", ADDRESS, "/a")


def look(facts: DebuggedNode, tools: DebugTools) -> tuple[DebugMethod, ...]:
    found = list_debug_methods(facts, tools, ADDRESS)
    assert isinstance(found, DebugMethods), found
    return found.methods


@pytest.mark.parametrize(("tools", "command", "here"), [
    (HERE, (*ATTACH, "gdb", "-q", "-p", "12"), True),
    (replace(HERE, may_attach=False), (*ATTACH, "sudo", "gdb", "-q", "-p", "12"), True),
    (TMUX, ("tmux", "split-window", "-h", *ATTACH, "gdb", "-q", "-p", "12"), False),
    (DISPLAY, ("xterm", "-T", "/a", "-e", *ATTACH, "gdb", "-q", "-p", "12"), False),
])  # fmt: skip
def test_gdb_takes_a_program_that_runs(tools: DebugTools, command: tuple[str, ...], here: bool) -> None:
    (method,) = look(BINARY, tools)
    assert (method.command, method.here, method.prefix) == (command, here, ())


def test_script_that_became_a_program_is_taken_by_gdb() -> None:
    (method,) = look(DebuggedNode(DebugTarget("/a", "script"), "/x/a", 12, "/x/real"), HERE)
    assert method.command == (*ATTACH, "gdb", "-q", "-p", "12")


@pytest.mark.parametrize(("facts", "tool"), [
    (PYTHON, ("/usr/bin/python3", "-m", "pudb")),
    (replace(PYTHON, pid=None, process=""), ("/usr/bin/python3", "-m", "pudb")),
    (MODULE, ("env", "UR_NODE_PYTHON_OPTIONS=-m pudb")),
])  # fmt: skip
def test_python_is_started_again_in_pudb(facts: DebuggedNode, tool: tuple[str, ...]) -> None:
    for tools, before in ((HERE, ()), (TMUX, ("tmux", "split-window", "-h")), (DISPLAY, ("xterm", "-T", "/a", "-e"))):
        (method,) = look(facts, tools)
        assert method.command == (*before, *WAIT)
        assert method.prefix == (*JOIN, *tool)
        assert method.here == (tools is HERE)


def test_restart_that_loses_something_says_so() -> None:
    found = list_debug_methods(PYTHON, HERE, ADDRESS)
    assert isinstance(found, DebugMethods)
    assert "lost" in found.note
    found = list_debug_methods(replace(PYTHON, pid=None, process=""), HERE, ADDRESS)
    assert isinstance(found, DebugMethods)
    assert not found.note


def test_crash_with_a_core_file_offers_that_first() -> None:
    core, again = look(replace(BINARY, pid=None, process="", core_dump=("gdb", "-q", "/x/a", "/core")), HERE)
    assert (core.command, core.prefix) == (("gdb", "-q", "/x/a", "/core"), ())
    assert again.prefix[: len(JOIN)] == JOIN
    assert again.prefix[len(JOIN)] == "gdb"


def test_crash_without_core_file_says_why_and_offers_a_new_start() -> None:
    found = list_debug_methods(replace(BINARY, pid=None, process="", no_core_dump="limited to 0"), HERE, ADDRESS)
    assert isinstance(found, DebugMethods)
    assert found.note == "limited to 0"
    assert [method.key for method in found.methods] == ["g"]


@pytest.mark.parametrize(("facts", "tools", "told"), [
    (BINARY, replace(HERE, installed=frozenset()), "sudo apt-get install gdb"),
    (PYTHON, replace(HERE, installed=frozenset({"gdb"})), "sudo apt-get install python3-pudb"),
    (DebuggedNode(DebugTarget("/a", "script"), "/x/a", 12, "/usr/bin/bash"), HERE, "bash -x"),
    (DebuggedNode(DebugTarget("/a", "script"), "/x/a"), HERE, "does not run"),
    (BINARY, replace(HERE, terminal=False), "no terminal"),
])  # fmt: skip
def test_node_that_cannot_be_debugged_has_a_reason(facts: DebuggedNode, tools: DebugTools, told: str) -> None:
    assert told in str(list_debug_methods(facts, tools, ADDRESS))
