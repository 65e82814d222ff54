from dataclasses import replace

import pytest

from ur.run.debugger.choice import (
    DebugTarget,
    DebugTools,
    Kind,
    Tool,
    choose_tool,
    find_kind,
    plan_debugging,
)
from ur.source.diagnostic import UserError

ALL = frozenset({"gdb", "pudb", "debugpy", "xterm"})
HERE = DebugTools(terminal=True, installed=ALL)
DISPLAY = replace(HERE, display=True)
NOTHING = replace(HERE, terminal=False)
PYTHON = DebugTarget("/a", "python", "/usr/bin/python3")
BINARY = DebugTarget("/a", "binary")


@pytest.mark.parametrize(("head", "kind", "interpreter"), [
    (b"\x7fELF\x02", "binary", ""),
    (b"#!/usr/bin/python3\nimport x", "python", "/usr/bin/python3"),
    (b"#!/usr/bin/env python3\n", "python", "python3"),
    (b"#!/usr/bin/env -S A=1 python3.11 -u\n", "python", "python3.11"),
    (b'#!/bin/bash\nexec "$(dirname "$0")/../../lib/node" ur_nodes.x "$@"', "module", ""),
    (b"#!/bin/bash\necho", "script", ""),
    (b"text", "script", ""),
    (b"", "script", ""),
    (b"#!", "script", ""),
])  # fmt: skip
def test_kind_of_a_program(head: bytes, kind: Kind, interpreter: str) -> None:
    assert find_kind(head) == (kind, interpreter)


@pytest.mark.parametrize(("kind", "tool"), [("binary", "gdb"), ("python", "pudb"), ("module", "pudb")])
def test_tool_without_a_wish(kind: Kind, tool: Tool) -> None:
    assert choose_tool(kind) == tool


@pytest.mark.parametrize(("tool", "target", "tools", "terminal", "begins"), [
    ("pudb", PYTHON, HERE, "here", ("/usr/bin/python3", "-m", "pudb")),
    ("pudb", PYTHON, DISPLAY, "window", ("xterm", "-T", "/a", "-e", "/usr/bin/python3", "-m", "pudb")),
    ("pudb", PYTHON, replace(DISPLAY, installed=ALL - {"xterm"}), "here", ("/usr/bin/python3",)),
    ("pudb", DebugTarget("/a", "module"), HERE, "here", ("env", "UR_NODE_PYTHON_OPTIONS=-m pudb")),
    ("gdb", BINARY, HERE, "here", ("gdb", "-q")),
    ("gdb", BINARY, NOTHING, "log", ("gdb", "-q", "-batch")),
    ("debugpy", PYTHON, NOTHING, "log", ("/usr/bin/python3", "-m", "debugpy", "--listen", "localhost:5679")),
])  # fmt: skip
def test_place_and_prefix(
    tool: Tool, target: DebugTarget, tools: DebugTools, terminal: str, begins: tuple[str, ...]
) -> None:
    plan = plan_debugging(target, tool, tools, 5679)
    assert plan.terminal == terminal
    assert plan.prefix[: len(begins)] == begins
    assert terminal != "log" or plan.notes


def test_python_in_gdb_runs_its_interpreter() -> None:
    assert plan_debugging(PYTHON, "gdb", HERE, 1).prefix[-2:] == ("--args", "/usr/bin/python3")


@pytest.mark.parametrize(("tool", "target", "tools", "told"), [
    ("pudb", PYTHON, NOTHING, "=debugpy"),
    ("pudb", BINARY, HERE, "=gdb"),
    ("gdb", DebugTarget("/a", "script"), HERE, "bash -x"),
    ("gdb", DebugTarget("/a", "module"), HERE, "=pudb"),
    ("pudb", PYTHON, replace(HERE, installed=frozenset()), "python3-pudb"),
    ("gdb", BINARY, replace(HERE, installed=frozenset()), "apt-get install gdb"),
    ("debugpy", PYTHON, replace(HERE, installed=frozenset()), "python3-debugpy"),
])  # fmt: skip
def test_what_cannot_be_debugged_says_what_to_do(tool: Tool, target: DebugTarget, tools: DebugTools, told: str) -> None:
    with pytest.raises(UserError) as caught:
        plan_debugging(target, tool, tools, 1)
    assert told in (caught.value.diagnostics[0].help or "")
    assert f"--debug /a={tool}" in str(caught.value)
