"""An exploration of a bus on a pseudo-terminal, and in lines."""

import os
import threading
from collections.abc import Iterator
from contextlib import redirect_stdout
from functools import partial

import numpy as np
import pytest
from tests.fakes.mux import FakeMux
from tests.ur_nodes.teleop.recordings import SAVED, serve_recordings
from tests.ur_nodes.teleop.screen import TypedTerminal, running

from ur_nodes.client.exploration import ExplorationStatus, ExplorationTopics
from ur_nodes.client.mux import MuxLink
from ur_nodes.client.saving import MapSaving, save_recordings
from ur_nodes.exploration.status import ExploreStatus, write_status
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Map, Marker, Markers, Result
from ur_nodes.teleop.explore.explore_terminal import (
    add_exploration,
    exit_code,
    finish,
    print_exploration,
    show_exploration,
)
from ur_nodes.teleop.map_view.map_feed import MapFeed

EXPLORING = ExploreStatus("exploring", 2, 5.0, 8.0)


class ExploreRun:
    """An exploration, its map, its mux and its mapping node on a bus, and the screen of the program."""

    def __init__(self) -> None:
        self.bus = Bus()
        node, robot = self.bus.node("explore_progress"), self.bus.node("explore")
        self._statuses = robot.publish("status", str, Quality.LATCHED)
        self.tell(EXPLORING)
        grid = Grid(np.zeros((20, 20), np.int8), 0.1, Pose2(-1.0, -1.0, 0.0))
        robot.publish("map", Map, Quality.LATCHED).send(Map(0, "map", grid))
        points = np.array([(0.5, 0.5, 0.0), (0.6, 0.5, 0.0), (0.7, 0.5, 0.0)])
        open_, blocked = ((0.0, 0.0, 1.0, 1.0), (1.0, 0.0, 0.0, 1.0))
        markers = tuple(
            Marker("frontier", number, "points", Pose2(0.0, 0.0, 0.0).in_space(), (0.1, 0.1, 0.0), colour, "", where)
            for number, (colour, where) in enumerate(((open_, points), (blocked, -points)))
        )
        robot.publish("frontiers", Markers, Quality.LATCHED).send(Markers(0, "map", markers))
        self.saves = 0
        robot.serve("save", Trigger, self._save)
        self.mux = FakeMux(self.bus)
        self.statuses = ExplorationStatus(node)
        additions = partial(add_exploration, ExplorationTopics(node))
        feed = MapFeed(node, "map", "base_footprint", colour=False, additions=additions)
        link, saving = MuxLink(node, "cmd_vel_mux"), MapSaving(node, "save", hint="")
        serve_recordings(self.bus)
        recording = save_recordings(node)
        self.screen = TypedTerminal(
            lambda terminal, ended: show_exploration(terminal, self.statuses, feed, link, recording, saving, ended)
        )

    def tell(self, status: ExploreStatus) -> None:
        self._statuses.send(write_status(status))

    def _save(self, _request: Trigger) -> Result:
        self.saves += 1
        return Result(True, "flat")


@pytest.fixture
def run() -> Iterator[ExploreRun]:
    started = ExploreRun()
    with running(started.bus), started.screen:
        yield started


def test_map_frontiers_and_progress_are_shown(run: ExploreRun) -> None:
    run.screen.wait_for("▲ exploring")
    run.screen.wait_for("?")
    run.screen.wait_for("x")


def test_keys_save_stop_and_release(run: ExploreRun) -> None:
    run.screen.type("s ")
    run.screen.wait_for("EMERGENCY STOP")
    run.screen.type("r")
    run.screen.wait(lambda: run.mux.asked == ["stop", "release"] and run.saves == 1)
    run.screen.wait_for("map 'flat' saved")
    run.screen.type("n")
    run.screen.wait_for(SAVED)


def test_ctrl_c_ends_the_screen(run: ExploreRun) -> None:
    run.screen.type("\x03")
    run.screen.wait_end()


def test_end_of_the_exploration_ends_the_screen(run: ExploreRun) -> None:
    run.bus.node("explore").publish("status", str, Quality.LATCHED).send(
        write_status(ExploreStatus("complete", known=20.0, saved="flat"))
    )
    run.screen.wait_end()


def test_lines_are_printed_for_each_state_and_at_the_end(capsys: pytest.CaptureFixture[str]) -> None:
    bus = Bus()
    statuses = ExplorationStatus(bus.node("explore_progress"))
    publisher = bus.node("explore").publish("status", str, Quality.LATCHED)
    thread = threading.Thread(target=print_exploration, args=(statuses, 100.0, threading.Event()))
    thread.start()
    out = ""
    for status, line in (
        (EXPLORING, "2 frontiers left"),
        (ExploreStatus("paused", 2, 5.0, 8.0, reason="the emergency stop is pressed"), "paused: the emergency stop"),
    ):
        publisher.send(write_status(status))
        bus.run(0.1)
        while line not in out:
            assert thread.is_alive()
            thread.join(0.01)
            out += capsys.readouterr().out
    publisher.send(write_status(ExploreStatus("complete", known=20.0, saved="flat")))
    bus.run(0.1)
    thread.join(60.0)
    assert out.count("\n") == 2
    assert finish("explore_progress", statuses.newest) == 0
    assert "ur run keyboard_navigate map:=flat" in capsys.readouterr().out


def test_exploration_without_a_map_names_that(capsys: pytest.CaptureFixture[str]) -> None:
    assert finish("explore_progress", EXPLORING) == 130
    shown = capsys.readouterr()
    assert shown.out.startswith("stopped before the map was complete; ")
    assert shown.err == "error: explore_progress: no map is stored, expected one of this exploration\n"


@pytest.mark.parametrize(
    ("status", "code"),
    [
        (ExploreStatus("complete", saved="flat"), 0),
        (ExploreStatus("complete"), 1),
        (ExploreStatus("incomplete", saved="flat"), 1),
        (ExploreStatus("stopped", saved="flat"), 130),
        (ExploreStatus("exploring", saved="flat"), 130),
    ],
)
def test_exit_code_tells_complete_incomplete_and_interrupted_apart(status: ExploreStatus, code: int) -> None:
    assert exit_code(status) == code


def test_line_that_is_longer_than_the_terminal_is_broken_between_words(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    reader, writer = os.openpty()
    with os.fdopen(reader, "rb") as screen, os.fdopen(writer, "w", encoding="utf-8") as terminal:
        with redirect_stdout(terminal):
            finish("explore", ExploreStatus("complete", known=266.0, way=139.0, saved="flat"))
        out = screen.read1(4096).decode().replace("\r", "")
    assert "266 m² known" in out.replace("\n", " ")
    assert all(len(line) <= 60 for line in out.splitlines())
