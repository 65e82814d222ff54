"""A run ends although a debugger holds one of its nodes."""

import select
import shutil
import subprocess
import time
from collections.abc import Callable

import psutil
import pytest
from tests.run.conftest import RunWorld

from ur.run.clients.client import RunClient, connect_run
from ur.run.clients.protocol import NodeChanged, RunEvent

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


@pytest.mark.skipif(shutil.which("gdb") is None, reason="gdb is not installed")
def test_end_of_a_run_ends_a_gdb_that_holds_a_node(world: RunWorld) -> None:
    launched = world.launch(BODY)
    launched.until("[/one] started", limit=60)
    with watch(world) as client:
        pid = runs_anew(client, 0).pid or 0
    until_command(pid, "sleep")
    command = ["gdb", "-q", "-nx", "-p", str(pid)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.STDOUT, text=True) as gdb:
        try:
            assert gdb.stdin is not None
            assert gdb.stdout is not None
            gdb.stdin.write("echo it is held\\n\n")
            gdb.stdin.flush()
            assert any("it is held" in line for line in gdb.stdout)
            launched.process.terminate()
            assert launched.wait(60) == 0
            assert gdb.wait(60) is not None
        finally:
            gdb.kill()
    launched.wait_nothing_left(60)
