"""The process of all nodes: its end while nodes still start."""

import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace

import pytest

from ur_nodes.one_process.host import Host, NodeStart, ProcessPlan

LIMIT = 20.0  # s

# The last node that starts holds the terminal's node until it starts, and then waits for the end of another node.
SHOW = """
import shared
from ur_nodes.run import attach

with attach("show", lambda node: None, lambda: None):
    shared.loading.wait(shared.limit)
"""
BASE = """
import shared
from ur_nodes.run import run

run("base", lambda node: None)
shared.base_over.set()
shared.late_over.wait(shared.limit)
"""
LATE = """
import shared
from ur_nodes.run import run

shared.starter = shared.find_starter()
shared.loading.set()
shared.base_over.wait(shared.limit)
run("late", lambda node: None)
shared.late_over.set()
"""
BLOCKS = """
import atexit, sys, threading

atexit.register(threading.Event().wait)
sys.stdout.write("printed")
sys.exit(3)
"""
NEVER = "import shared\nshared.started_after_end = True\n"


@pytest.fixture
def shared(monkeypatch: pytest.MonkeyPatch) -> Iterator[SimpleNamespace]:
    """What the modules of the nodes import. A host changes the arguments and streams of its process."""
    made = SimpleNamespace(
        limit=LIMIT,
        loading=threading.Event(),
        base_over=threading.Event(),
        late_over=threading.Event(),
        started_after_end=False,
        find_starter=lambda: next(each for each in threading.enumerate() if each.name == "starts"),
    )
    monkeypatch.setitem(sys.modules, "shared", made)
    monkeypatch.setenv("ROS_VERSION", "0")
    before = sys.argv, sys.stdout, sys.stderr
    yield made
    sys.argv, sys.stdout, sys.stderr = before


def write_plan(folder: Path, modules: dict[str, str]) -> ProcessPlan:
    """Write modules of nodes, the first of which has the terminal."""
    starts: list[NodeStart] = []
    for name, text in modules.items():
        file = folder / f"{name}.py"
        file.write_text(text)
        starts.append(NodeStart(f"/{name}", (str(file),), terminal=not starts))
    parameters = folder / "parameters.json"
    parameters.write_text("{}")
    return ProcessPlan(starts[0].name, tuple(starts), str(folder / "nodes.log"), str(parameters), str(folder / "v"))


def test_node_that_starts_while_the_run_ends_ends_with_it(tmp_path: Path, shared: SimpleNamespace) -> None:
    plan = write_plan(tmp_path, {"show": SHOW, "base": BASE, "late": LATE, "never": NEVER})
    assert Host(plan).run() == 0
    assert shared.late_over.is_set()
    shared.starter.join(LIMIT)
    assert not shared.starter.is_alive()
    assert not shared.started_after_end


def test_process_ends_where_a_library_blocks_the_end_of_python(tmp_path: Path) -> None:
    file = tmp_path / "nodes.json"
    file.write_text(json.dumps(asdict(write_plan(tmp_path, {"blocks": BLOCKS}))))
    command = [sys.executable, "-I", "-m", "ur_nodes", "ur_nodes.one_process.host", str(file)]
    environment = {**os.environ, "ROS_VERSION": "0"}
    ended = subprocess.run(command, env=environment, stdout=subprocess.PIPE, timeout=LIMIT, check=False)
    assert (ended.returncode, ended.stdout) == (3, b"printed")
