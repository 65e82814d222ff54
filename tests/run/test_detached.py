"""Runs that go on without their terminal, and everything that reaches them from another one."""

import json
import os
import re
import signal
import time
from pathlib import Path
from typing import Any

import pytest
from tests.run.leftovers import wait_nothing_left

from ur.run.clients.client import connect_run, iterate_events
from ur.run.clients.protocol import (
    NodeChanged,
    OutputLine,
    RunEnded,
    RunEvent,
    RunStarted,
    StatsSampled,
    StopRun,
    Synchronised,
    Watch,
)
from ur.run.supervisor.events import KillNode, StartNode, StopNode

pytestmark = pytest.mark.ros

SLEEPER = '<node pkg="little_nodes" type="sleeper" name="sleeper"><!--ready: process--></node>'
TICKER = '<node pkg="little_nodes" type="ticker" name="ticker" output="{}"/>'


def start(world: Any, body: str, *words: str) -> str:
    """Start a detached run; return its id."""
    text: str = world.call("launch", "--detach", *words, world.write(body))
    return next(line for line in text.splitlines() if line.startswith("test."))


def test_detached_run_outlives_its_terminal_and_is_stopped_from_another(world: Any) -> None:
    run = world.launch(SLEEPER, "--detach", terminal=True)
    run.until("test.")
    assert run.wait() == 0
    os.close(run.keeper)  # the terminal is gone
    if run.output >= 0:
        os.close(run.output)
    run.keeper = run.output = -1
    assert "detached" in world.call("ps")
    [listed] = json.loads(world.call("ps", "--json"))
    assert listed["title"] == "test"
    assert f"{listed['run']} has ended" in world.call("stop")
    wait_nothing_left(world.folder, without=frozenset({world.master_pid}))
    assert "no run is active" in world.call("ps")
    assert not Path(listed["folder"]).exists()


def test_detached_run_that_cannot_start_says_why_and_returns_its_exit_code(world: Any) -> None:
    assert "no executable 'slepper'" in world.call(
        "launch", "--detach", world.write(SLEEPER.replace('"sleeper"', '"slepper"', 1)), code=1
    )
    assert "needs the terminal" in world.call(
        "launch", "--detach", world.write(SLEEPER.replace("ready: process", "terminal: x")), code=1
    )
    wait_nothing_left(world.folder, without=frozenset({world.master_pid}))


@pytest.mark.usefixtures("master")
def test_logs_of_a_run_that_writes_to_its_terminal_name_its_nodes(world: Any) -> None:
    run = world.launch(SLEEPER)
    run.until("[/sleeper] started")
    said = world.call("logs", code=2)
    assert "writes to its terminal, expected a node: one of /sleeper" in said
    assert "ur logs /sleeper" in said
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0


@pytest.mark.usefixtures("master")
def test_logs_attach_and_restart_reach_a_detached_run(world: Any) -> None:
    name = start(world, SLEEPER + TICKER.format("log"))
    attached = world.ur("attach", name)
    attached.until("[/sleeper] running", "[/ticker] tick")
    followed = world.ur("logs", "-f", "ticker")
    followed.until("tick\ntick\n")
    assert "/ticker runs again" in world.call("restart", "ticker")
    attached.until("[/ticker] started")
    assert "did you mean /sleeper?" in world.call("restart", "sleper", code=2)
    assert world.call("logs", "sleeper", "--path").strip().endswith("-stdout.log")
    assert "[/ticker] started" in world.call("logs")
    printed = world.call("logs", "sleeper")
    assert re.search(r"^node /sleeper has printed nothing since it was started (\d+ min )?\d+ s ago$", printed, re.M)
    assert "printed nothing" not in world.call("logs", "ticker")
    world.call("stop", name)
    assert attached.wait() == 0
    assert followed.wait() == 0
    wait_nothing_left(world.folder, without=frozenset({world.master_pid}))


@pytest.mark.usefixtures("master")
def test_attached_viewer_that_leaves_does_not_stop_the_run(world: Any) -> None:
    name = start(world, SLEEPER)
    attached = world.ur("attach", name)
    attached.until("[/sleeper] running")
    attached.process.send_signal(signal.SIGINT)
    assert attached.wait() == 0
    assert "runs on" in attached.text
    assert name in world.call("ps")
    world.call("stop", "--all")
    wait_nothing_left(world.folder, without=frozenset({world.master_pid}))


@pytest.mark.usefixtures("master")
def test_wait_returns_when_all_is_up_and_else_names_what_is_missing(world: Any) -> None:
    talker = (
        '<node pkg="little_nodes" type="talker" name="talker"><!--ready: topic chat; service ~get_loggers--></node>'
    )
    start(world, SLEEPER + talker, "--wait")
    world.call("wait")
    world.call("stop")
    never = SLEEPER.replace("ready: process", "ready: topic scan 5 Hz") + TICKER.format("log")
    crash = '<node pkg="little_nodes" type="crash" name="crash"/>'
    text = world.call("launch", "--detach", "--wait", "--timeout-ready=1", world.write(never + crash), code=1)
    assert "/sleeper: it runs, but is not registered yet" in text
    assert "/ticker: it runs, but is not registered" in text
    assert "/crash: it does not run: ended, exit code 3 (log: " in text
    world.call("stop")


@pytest.mark.usefixtures("master")
def test_run_killed_with_9_is_not_listed_any_more(world: Any) -> None:
    start(world, SLEEPER)
    [listed] = json.loads(world.call("ps", "--json"))
    os.kill(listed["pid"], signal.SIGKILL)
    wait_nothing_left(world.folder, without=frozenset({world.master_pid}))
    assert "no run is active" in world.call("ps")
    assert not Path(listed["folder"]).exists()


@pytest.mark.usefixtures("master")
def test_events_on_standard_output_tell_the_whole_run(world: Any) -> None:
    run = world.launch(TICKER.format("screen"), "--json")
    run.until('"tick"')
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0
    lines = [json.loads(line) for line in run.text.splitlines() if line.startswith("{")]
    kinds = [line["kind"] for line in lines]
    assert kinds[0] == "RunStarted"
    assert kinds[-1] == "RunEnded"
    states = [line["state"] for line in lines if line["kind"] == "NodeChanged"]
    assert states == ["waiting", "starting", "running", "stopping", "ended"]
    assert "[/ticker]" not in run.text.replace('"text": "[/ticker]', "")


class DetachedViewer:
    """A client that remembers the last state of every node."""

    def __init__(self, folder: str) -> None:
        self.client = connect_run(folder)
        self.events = iterate_events(self.client, timeout=60.0)
        self.nodes: dict[str, NodeChanged] = {}

    def until(self, wanted: Any) -> RunEvent:
        end = time.monotonic() + 60
        for event in self.events:
            if isinstance(event, NodeChanged):
                self.nodes[event.name] = event
            if wanted(event):
                return event
            assert time.monotonic() < end
        raise AssertionError(f"never came; nodes are {self.nodes}")

    def until_state(self, name: str, state: str) -> NodeChanged:
        self.until(lambda event: isinstance(event, NodeChanged) and (event.name, event.state) == (name, state))
        return self.nodes[name]


@pytest.mark.usefixtures("master")
def test_viewer_sees_the_state_first_and_steers_every_node(world: Any) -> None:
    start(world, SLEEPER + TICKER.format("log"))
    [listed] = json.loads(world.call("ps", "--json"))
    viewer = DetachedViewer(listed["folder"])
    first = viewer.until(lambda _: True)
    assert isinstance(first, RunStarted)
    assert (first.run, first.pid, first.detached) == (listed["run"], listed["pid"], True)
    viewer.until(lambda event: isinstance(event, Synchronised))
    assert viewer.nodes["/sleeper"].state == "running"
    viewer.client.send(StopNode("/sleeper"))
    assert viewer.until_state("/sleeper", "ended").held
    viewer.client.send(StartNode("/sleeper"))
    assert viewer.until_state("/sleeper", "running").restarts == 0
    viewer.client.send(KillNode("/sleeper"))
    assert viewer.until_state("/sleeper", "ended").signal == signal.SIGKILL
    viewer.client.send(Watch(output=True, stats=True))
    line = viewer.until(lambda event: isinstance(event, OutputLine))
    assert isinstance(line, OutputLine)
    assert (line.name, line.stream, line.text) == ("/ticker", "log", "tick")
    stats = viewer.until(lambda event: isinstance(event, StatsSampled))
    assert isinstance(stats, StatsSampled)
    assert [each.name for each in stats.nodes] == ["/ticker"]
    assert stats.nodes[0].memory > 100_000
    viewer.client.send(StopRun("enough"))
    end = viewer.until(lambda event: isinstance(event, RunEnded))
    assert end == RunEnded(0)
    viewer.client.close()
    wait_nothing_left(world.folder, without=frozenset({world.master_pid}))


def test_attached_terminal_ends_when_nobody_reads_it_though_nothing_is_printed(world: Any) -> None:
    run = start(world, SLEEPER)
    attached = world.ur("attach", "--plain", run)
    attached.until("sleeper")
    os.close(attached.output)
    attached.output = -1
    assert attached.wait() == 128 + signal.SIGPIPE
    assert run in world.call("ps")
    world.call("stop")
