"""A node that runs is started again with other words in front, once: what the debugger key asks for."""

from __future__ import annotations

import select
import shlex
import sys
import time
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest
from tests.run.conftest import RunWorld
from tests.run.debugger.test_pane import Tmux, tmux, until  # noqa: F401 - a fixture

from ur.run.clients.client import RunClient, connect_run
from ur.run.clients.protocol import NodeChanged, RestartNode, RunEvent
from ur.run.debugger import pane as debug_pane

pytestmark = pytest.mark.ros
BODY = '<node pkg="little_nodes" type="sleeper" name="one" launch-prefix="nice -n 1"/>'


def watch(world: RunWorld) -> RunClient:
    (folder,) = (world.folder / "state/ur/runs").iterdir()
    return connect_run(str(folder))


def await_event(client: RunClient, holds: Callable[[RunEvent], bool]) -> RunEvent:
    end = time.monotonic() + 60
    while time.monotonic() < end:
        select.select([client], [], [], 1.0)
        for event in client.receive() or ():
            if holds(event):
                return event
    raise AssertionError("it did not come about")


def runs_anew(client: RunClient, before: int) -> NodeChanged:
    event = await_event(
        client,
        lambda it: (
            isinstance(it, NodeChanged) and it.name == "/one" and it.state == "running" and it.pid not in (None, before)
        ),
    )
    assert isinstance(event, NodeChanged)
    return event


def until_command(pid: int, begins: str) -> None:
    process = psutil.Process(pid)
    end = time.monotonic() + 60
    while not " ".join(process.cmdline()).startswith(begins):
        assert time.monotonic() < end, process.cmdline()
        time.sleep(0.02)


def test_prefix_holds_for_one_start_and_takes_the_place_of_the_nodes_own(world: RunWorld) -> None:
    own = psutil.Process().nice()
    launched = world.launch(BODY)
    launched.until("[/one] started", limit=60)
    with watch(world) as client:
        first = runs_anew(client, 0)
        assert first.program == f"{world.folder}/little_nodes/nodes/sleeper"
        assert first.folder == f"{world.folder}/ros"
        until_command(first.pid or 0, "sleep")
        assert psutil.Process(first.pid or 0).nice() == own + 1
        client.send(RestartNode("/one", ("env", "MARK=1")))
        second = runs_anew(client, first.pid or 0)
        until_command(second.pid or 0, "sleep")
        assert psutil.Process(second.pid or 0).environ().get("MARK") == "1"
        assert psutil.Process(second.pid or 0).nice() == own
        client.send(RestartNode("/one"))
        third = runs_anew(client, second.pid or 0)
        until_command(third.pid or 0, "sleep")
        assert "MARK" not in psutil.Process(third.pid or 0).environ()
        assert psutil.Process(third.pid or 0).nice() == own + 1


def test_node_is_debugged_in_another_terminal_and_ends_with_its_run(
    world: RunWorld,
    tmux: Tmux,  # noqa: F811 - a fixture
) -> None:
    launched = world.launch(
        '<node pkg="little_nodes" type="screen" name="one" output="screen"/>' + BODY.replace("one", "two")
    )
    launched.until("[/two] started", limit=60)
    address = f"{world.folder}/made/join"
    wait = shlex.join([sys.executable, debug_pane.__file__, "--wait", address, "/one"])
    tmux("new-session", "-d", "-x", "100", "-y", "20", f"{wait}; echo over; exec cat")
    until(lambda: Path(address).exists(), lambda: tmux("capture-pane", "-p"))
    with watch(world) as client:
        client.send(RestartNode("/one", (sys.executable, debug_pane.__file__, "--join", address, "/one")))
        until(lambda: "ready" in tmux("capture-pane", "-p"), lambda: tmux("capture-pane", "-p"))
        launched.look()
    launched.process.terminate()
    assert launched.wait(60) == 0
    until(lambda: "over" in tmux("capture-pane", "-p"), lambda: tmux("capture-pane", "-p"))
    launched.wait_nothing_left(60)
