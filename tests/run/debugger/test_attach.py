from __future__ import annotations

from dataclasses import replace

import pytest

from ur.run.debugger.attach import Looked, Way, Ways, plan_looking
from ur.run.debugger.choice import Surroundings, Target

ALL = frozenset({"gdb", "pudb", "debugpy", "xterm"})
HERE = Surroundings(terminal=True, tools=ALL, python="/p", pane_program="/pane.py")
TMUX = replace(HERE, tmux=True)
DISPLAY = replace(HERE, display=True)
BINARY = Looked(Target("/a", "binary"), "/x/a", 12, "/x/a")
PYTHON = Looked(Target("/a", "python", "/usr/bin/python3"), "/x/a", 12, "/usr/bin/python3.11")
MODULE = Looked(Target("/a", "module"), "/x/a", 12, "/venv/bin/python3")
ADDRESS = "/tmp/d/join"
WAIT = ("/p", "-I", "/pane.py", "--wait", ADDRESS, "/a")
ATTACH = ("/p", "-I", "/pane.py", "--attach", "12")
JOIN = ("/p", "-I", "/pane.py", "--join", ADDRESS, "/a")


def look(looked: Looked, around: Surroundings) -> tuple[Way, ...]:
    found = plan_looking(looked, around, ADDRESS)
    assert isinstance(found, Ways), found
    return found.ways


@pytest.mark.parametrize(("around", "command", "here"), [
    (HERE, (*ATTACH, "gdb", "-q", "-p", "12"), True),
    (replace(HERE, may_attach=False), (*ATTACH, "sudo", "gdb", "-q", "-p", "12"), True),
    (TMUX, ("tmux", "split-window", "-h", *ATTACH, "gdb", "-q", "-p", "12"), False),
    (DISPLAY, ("xterm", "-T", "/a", "-e", *ATTACH, "gdb", "-q", "-p", "12"), False),
])  # fmt: skip
def test_gdb_takes_a_program_that_runs(around: Surroundings, command: tuple[str, ...], here: bool) -> None:
    (way,) = look(BINARY, around)
    assert (way.command, way.here, way.prefix) == (command, here, ())


def test_script_that_became_a_program_is_taken_by_gdb() -> None:
    (way,) = look(Looked(Target("/a", "script"), "/x/a", 12, "/x/real"), HERE)
    assert way.command == (*ATTACH, "gdb", "-q", "-p", "12")


@pytest.mark.parametrize(("looked", "tool"), [
    (PYTHON, ("/usr/bin/python3", "-m", "pudb")),
    (replace(PYTHON, pid=None, process=""), ("/usr/bin/python3", "-m", "pudb")),
    (MODULE, ("env", "UR_NODE_PYTHON_OPTIONS=-m pudb")),
])  # fmt: skip
def test_python_is_started_again_in_pudb(looked: Looked, tool: tuple[str, ...]) -> None:
    for around, before in ((HERE, ()), (TMUX, ("tmux", "split-window", "-h")), (DISPLAY, ("xterm", "-T", "/a", "-e"))):
        (way,) = look(looked, around)
        assert way.command == (*before, *WAIT)
        assert way.prefix == (*JOIN, *tool)
        assert way.here == (around is HERE)


def test_restart_that_loses_something_says_so() -> None:
    found = plan_looking(PYTHON, HERE, ADDRESS)
    assert isinstance(found, Ways)
    assert "lost" in found.note
    found = plan_looking(replace(PYTHON, pid=None, process=""), HERE, ADDRESS)
    assert isinstance(found, Ways)
    assert not found.note


def test_crash_with_a_core_file_offers_that_first() -> None:
    core, again = look(replace(BINARY, pid=None, process="", core=("gdb", "-q", "/x/a", "/core")), HERE)
    assert (core.command, core.prefix) == (("gdb", "-q", "/x/a", "/core"), ())
    assert again.prefix[: len(JOIN)] == JOIN
    assert again.prefix[len(JOIN)] == "gdb"


def test_crash_without_core_file_says_why_and_offers_a_new_start() -> None:
    found = plan_looking(replace(BINARY, pid=None, process="", no_core="limited to 0"), HERE, ADDRESS)
    assert isinstance(found, Ways)
    assert found.note == "limited to 0"
    assert [way.key for way in found.ways] == ["g"]


@pytest.mark.parametrize(("looked", "around", "told"), [
    (BINARY, replace(HERE, tools=frozenset()), "sudo apt-get install gdb"),
    (PYTHON, replace(HERE, tools=frozenset({"gdb"})), "sudo apt-get install python3-pudb"),
    (Looked(Target("/a", "script"), "/x/a", 12, "/usr/bin/bash"), HERE, "bash -x"),
    (Looked(Target("/a", "script"), "/x/a"), HERE, "does not run"),
    (BINARY, replace(HERE, terminal=False), "no terminal"),
])  # fmt: skip
def test_what_cannot_be_looked_into_says_why(looked: Looked, around: Surroundings, told: str) -> None:
    assert told in str(plan_looking(looked, around, ADDRESS))
