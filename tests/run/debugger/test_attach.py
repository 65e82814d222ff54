from __future__ import annotations

from dataclasses import replace

import pytest

from ur.run.debugger.attach import DebuggedNode, DebugMethod, DebugMethods, list_debug_methods
from ur.run.debugger.choice import DebugTarget, DebugTools

ALL = frozenset({"gdb", "pudb", "debugpy", "xterm"})
HERE = DebugTools(terminal=True, installed=ALL)
DISPLAY = replace(HERE, display=":7")
BINARY = DebuggedNode(DebugTarget("/a", "binary"), "/x/a", 12, "/x/a")
PYTHON = DebuggedNode(DebugTarget("/a", "python", "/usr/bin/python3"), "/x/a", 12, "/usr/bin/python3.11")
MODULE = DebuggedNode(DebugTarget("/a", "module"), "/x/a", 12, "/venv/bin/python3")
WINDOW = ("env", "DISPLAY=:7", "xterm", "-T", "/a", "-e")


def look(facts: DebuggedNode, tools: DebugTools) -> tuple[DebugMethod, ...]:
    found = list_debug_methods(facts, tools)
    assert isinstance(found, DebugMethods), found
    return found.methods


@pytest.mark.parametrize(("tools", "command", "here"), [
    (HERE, ("gdb", "-q", "-p", "12"), True),
    (replace(HERE, may_attach=False), ("sudo", "gdb", "-q", "-p", "12"), True),
    (DISPLAY, ("xterm", "-T", "/a", "-e", "gdb", "-q", "-p", "12"), False),
])  # fmt: skip
def test_gdb_takes_a_program_that_runs(tools: DebugTools, command: tuple[str, ...], here: bool) -> None:
    (method,) = look(BINARY, tools)
    assert (method.command, method.here, method.prefix) == (command, here, ())


def test_script_that_became_a_program_is_taken_by_gdb() -> None:
    (method,) = look(DebuggedNode(DebugTarget("/a", "script"), "/x/a", 12, "/x/real"), HERE)
    assert method.command == ("gdb", "-q", "-p", "12")


@pytest.mark.parametrize(("facts", "tool"), [
    (PYTHON, ("/usr/bin/python3", "-m", "pudb")),
    (replace(PYTHON, pid=None, process=""), ("/usr/bin/python3", "-m", "pudb")),
    (MODULE, ("env", "UR_NODE_PYTHON_OPTIONS=-m pudb")),
])  # fmt: skip
def test_python_is_started_again_in_pudb_in_a_window(facts: DebuggedNode, tool: tuple[str, ...]) -> None:
    (method,) = look(facts, DISPLAY)
    assert (method.command, method.prefix, method.here) == ((), (*WINDOW, *tool), False)
    assert "ur launch --debug /a ..." in str(list_debug_methods(facts, HERE))


def test_restart_that_loses_something_says_so() -> None:
    found = list_debug_methods(PYTHON, DISPLAY)
    assert isinstance(found, DebugMethods)
    assert "lost" in found.note
    found = list_debug_methods(replace(PYTHON, pid=None, process=""), DISPLAY)
    assert isinstance(found, DebugMethods)
    assert not found.note


def test_crash_with_a_core_file_offers_that_first() -> None:
    crashed = replace(BINARY, pid=None, process="", core_dump=("gdb", "-q", "/x/a", "/core"))
    core, again = look(crashed, DISPLAY)
    assert (core.command[-4:], core.prefix) == (("gdb", "-q", "/x/a", "/core"), ())
    assert again.prefix[: len(WINDOW) + 1] == (*WINDOW, "gdb")
    (core,) = look(crashed, HERE)
    assert (core.command, core.here) == (("gdb", "-q", "/x/a", "/core"), True)


def test_crash_without_core_file_says_why_and_offers_a_new_start() -> None:
    crashed = replace(BINARY, pid=None, process="", no_core_dump="limited to 0")
    found = list_debug_methods(crashed, DISPLAY)
    assert isinstance(found, DebugMethods)
    assert found.note == "limited to 0"
    assert [method.key for method in found.methods] == ["g"]
    assert str(list_debug_methods(crashed, HERE)).startswith("limited to 0; no window opens here: ur launch --debug")


@pytest.mark.parametrize(("facts", "tools", "told"), [
    (BINARY, replace(HERE, installed=frozenset()), "sudo apt-get install gdb"),
    (PYTHON, replace(HERE, installed=frozenset({"gdb"})), "sudo apt-get install python3-pudb"),
    (DebuggedNode(DebugTarget("/a", "script"), "/x/a", 12, "/usr/bin/bash"), HERE, "bash -x"),
    (DebuggedNode(DebugTarget("/a", "script"), "/x/a"), HERE, "does not run"),
    (BINARY, replace(HERE, terminal=False), "no terminal"),
])  # fmt: skip
def test_node_that_cannot_be_debugged_has_a_reason(facts: DebuggedNode, tools: DebugTools, told: str) -> None:
    assert told in str(list_debug_methods(facts, tools))
