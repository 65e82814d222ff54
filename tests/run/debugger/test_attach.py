import os
from dataclasses import replace
from pathlib import Path

import pytest

from ur.run.debugger.choice import DebuggedNode, DebuggerCommand, DebugTarget, DebugTools, choose_debugger
from ur.run.debugger.environment import read_node_facts

ALL = frozenset({"gdb", "pudb", "debugpy", "xterm"})
HERE = DebugTools(terminal=True, installed=ALL)
DISPLAY = replace(HERE, display=True)
BINARY = DebuggedNode(DebugTarget("/a", "binary"), 12, "/x/a")
CRASHED = replace(BINARY, pid=None, process="")
PYTHON = DebuggedNode(DebugTarget("/a", "python", "/usr/bin/python3"), 12, "/usr/bin/python3.11")
MODULE = DebuggedNode(DebugTarget("/a", "module"), 12, "/venv/bin/python3")


@pytest.mark.parametrize(("tools", "argv", "here"), [
    (HERE, ("gdb", "-q", "-p", "12"), True),
    (replace(HERE, may_attach=False), ("sudo", "gdb", "-q", "-p", "12"), True),
    (DISPLAY, ("xterm", "-T", "/a", "-e", "gdb", "-q", "-p", "12"), False),
])  # fmt: skip
def test_gdb_takes_a_program_that_runs(tools: DebugTools, argv: tuple[str, ...], here: bool) -> None:
    assert choose_debugger(BINARY, tools) == DebuggerCommand(argv, here)


def test_script_that_became_a_program_is_taken_by_gdb() -> None:
    found = choose_debugger(DebuggedNode(DebugTarget("/a", "script"), 12, "/x/real"), HERE)
    assert found == DebuggerCommand(("gdb", "-q", "-p", "12"), here=True)


@pytest.mark.parametrize(("facts", "tools", "told"), [
    (BINARY, replace(HERE, installed=frozenset()), "sudo apt-get install gdb"),
    (PYTHON, HERE, "ur launch --debug /a ... starts it in pudb"),
    (MODULE, DISPLAY, "ur launch --debug /a ... starts it in pudb"),
    (CRASHED, HERE, "ur launch --debug /a ... starts it in gdb"),
    (DebuggedNode(DebugTarget("/a", "script"), 12, "/usr/bin/bash"), HERE, "bash -x"),
    (DebuggedNode(DebugTarget("/a", "script")), HERE, "does not run"),
    (BINARY, replace(HERE, terminal=False), "no terminal"),
])  # fmt: skip
def test_node_that_cannot_be_debugged_has_a_reason(facts: DebuggedNode, tools: DebugTools, told: str) -> None:
    assert told in str(choose_debugger(facts, tools))


def test_facts_of_a_running_node_name_the_executable_of_its_process() -> None:
    facts = read_node_facts("/a", "/no/such/script", os.getpid())
    assert facts.process == str(Path("/proc/self/exe").readlink())
    assert facts.python
    assert read_node_facts("/a", "/bin/sh", 2**22 + 1).pid is None
