"""Mux, patrol, map saving and exploration, as user interfaces reach them, on a bus."""

import threading

import numpy as np
import pytest

from ur_nodes.client.exploration import ExplorationStatus, ExplorationTopics, FrontierPoint
from ur_nodes.client.mux import MuxLink, MuxView
from ur_nodes.client.patrol_text import (
    PatrolAnswer,
    PatrolLink,
    PatrolRequest,
    PatrolRoute,
    PatrolStatus,
    read_request,
    write_status,
)
from ur_nodes.client.saving import HINT, MapSaving
from ur_nodes.client.snapshot import RobotSnapshot
from ur_nodes.exploration.status import ExploreStatus
from ur_nodes.exploration.status import write_status as write_exploration
from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Switch, Trigger
from ur_nodes.ports.values import Marker, Markers, Path, Result, StampedPose

HERE = Pose3(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


@pytest.fixture
def bus() -> Bus:
    return Bus()


@pytest.fixture
def mux(bus: Bus) -> MemoryNode:
    node = bus.node("cmd_vel_mux")
    node.publish("~stopped", bool, Quality.LATCHED).send(False)
    node.publish("~active", str, Quality.LATCHED).send("idle")
    node.serve("~stop", Trigger, lambda _request: Result(True, "stopped"))
    node.serve("~release", Trigger, lambda _request: Result(False, "a key is still held"))
    node.serve("~set_obstacle_stop", Switch, lambda request: Result(not request.on, "there is no sensor"))
    return node


def test_mux_is_asked_and_its_answer_is_shown(bus: Bus, mux: MemoryNode) -> None:
    link = MuxLink(bus.node("screen"), mux.name)
    bus.run(0.1)
    assert link.view() == MuxView(stopped=False)
    link.ask("stop")
    bus.run(0.1)
    assert link.view().stopped is True
    link.ask("release")
    bus.run(0.1)
    assert link.view().problem == "not released: service /cmd_vel_mux/release: a key is still held"
    link.ask("obstacles off")
    bus.run(0.1)
    assert (link.view().asked, link.view().problem) == (None, "")
    mux.end("it is restarted")
    assert link.view().stopped is None


def test_mux_that_does_not_answer_is_reported(bus: Bus) -> None:
    link = MuxLink(bus.node("screen"), "cmd_vel_mux")
    link.ask("stop")
    bus.run(0.1)
    assert link.view().asked == "stop"
    bus.run(3.0)
    assert link.view().problem == ("NOT STOPPED: service /cmd_vel_mux/stop does not answer: is the robot running?")


def test_stop_takes_effect_when_the_mux_is_back_and_a_release_does_not(bus: Bus) -> None:
    link, asked = MuxLink(bus.node("screen"), "cmd_vel_mux"), list[str]()
    link.ask("release")
    bus.run(0.1)
    link.ask("stop")
    bus.run(5.0)
    assert link.view().problem.startswith("NOT STOPPED")
    mux = bus.node("cmd_vel_mux")
    mux.publish("~stopped", bool, Quality.LATCHED).send(False)
    for name in ("stop", "release"):
        mux.serve(f"~{name}", Trigger, lambda _, name=name: asked.append(name) or Result(True))  # type: ignore[func-returns-value, misc]
    bus.run(0.5)
    assert asked == ["stop"]
    assert link.view() == MuxView(stopped=True)


def test_patrol_is_asked_and_answers_once(bus: Bus) -> None:
    link = PatrolLink(bus.node("screen"))
    request = PatrolRequest("end", PatrolRoute(), "screen-1", "", "laptop", None)
    assert not link.request(request)
    assert link.status() is None
    patrol = bus.node("patrol")
    received: list[str] = []
    answers: list[str] = []
    statuses = patrol.publish("~status", str, Quality.LATCHED)
    patrol.subscribe("~request", str, received.append, Quality.EVERY)
    assert link.request(request, answers.append)
    bus.run(0.1)
    assert [read_request(each).id for each in received] == ["screen-1"]
    for _ in range(2):
        statuses.send(write_status(PatrolStatus(answer=PatrolAnswer("screen-1", "there is none"))))
        bus.run(0.1)
    assert answers == ["there is none"]
    assert link.status() == PatrolStatus(answer=PatrolAnswer("screen-1", "there is none"))
    statuses.send("{")
    bus.run(0.1)
    assert link.status() == PatrolStatus(answer=PatrolAnswer("screen-1", "there is none"))


def test_map_is_saved_once_at_a_time(bus: Bus) -> None:
    calls: list[Trigger] = []
    mapper = bus.node("mapper")

    def save(request: Trigger, give: object) -> None:
        calls.append(request)
        mapper.after(2.0, lambda: give(Result(True, "flat")))  # type: ignore[operator]

    mapper.serve_later("save", Trigger, save)
    saving = MapSaving(bus.node("screen"), "save")
    assert saving.pop_news() == HINT
    saving.ask()
    bus.run(0.1)
    saving.ask()
    assert saving.pop_news() == "saving the map ..."
    bus.run(3.0)
    assert saving.pop_news() == "map 'flat' saved"
    bus.run(0.1)
    assert saving.pop_news() == ""
    assert (saving.name, len(calls)) == ("flat", 1)


@pytest.mark.parametrize(
    ("answer", "line"),
    [
        (Result(False, "the disk is full"), "the map was not saved: the disk is full"),
        (Result(True, "../flat"), "the map was not saved: the service answers no name of a map"),
    ],
)
def test_map_that_is_not_saved_has_a_reason(bus: Bus, answer: Result, line: str) -> None:
    bus.node("mapper").serve("save", Trigger, lambda _request: answer)
    saving = MapSaving(bus.node("screen"), "save")
    saving.ask()
    bus.run(0.1)
    assert (saving.line, saving.name) == (line, "")


@pytest.mark.parametrize(
    ("answer", "line"),
    [
        (
            Result(True, "flat"),
            "the map is stored as 'flat'; navigate on it with\n    ur run keyboard_navigate map:=flat",
        ),
        (Result(False, "the disk is full"), "the map was not saved: the disk is full"),
    ],
)
def test_program_that_ends_saves_its_map_and_tells_how_to_go_on(bus: Bus, answer: Result, line: str) -> None:
    class Running(threading.Event):
        def wait(self, timeout: float | None = None) -> bool:
            bus.run(timeout or 0.0)
            return False

    bus.node("mapper").serve("save", Trigger, lambda _request: answer)
    saving = MapSaving(bus.node("screen"), "save")
    assert saving.save_last(Running()) == line


def test_exploration_is_shown_while_it_is_there_and_how_it_ended(bus: Bus) -> None:
    seen = ExplorationStatus(bus.node("screen"), "explore/status")
    explore = bus.node("explore")
    statuses = explore.publish("~status", str, Quality.LATCHED)
    assert seen.shown() is None
    statuses.send(write_exploration(ExploreStatus("exploring", known=2.0)))
    bus.run(0.1)
    assert seen.shown() == ExploreStatus("exploring", known=2.0)
    statuses.send("{")
    statuses.send(write_exploration(ExploreStatus("complete", saved="flat")))
    bus.run(0.1)
    explore.end("done")
    assert seen.shown() == ExploreStatus("complete", saved="flat")


def test_frontiers_goal_and_path_of_an_exploration_are_for_the_map(bus: Bus) -> None:
    topics, explore = ExplorationTopics(bus.node("screen")), bus.node("explore")
    points = np.array([(0.0, 0.0, 0.0), (1.0, 0.2, 0.0), (2.0, 0.0, 0.0)])
    red = Marker("frontiers", 1, "points", HERE, (0.1, 0.1, 0.0), (1.0, 0.0, 0.0, 1.0), "", points)
    explore.publish("frontiers", Markers, Quality.LATCHED).send(Markers(0, "map", (red,)))
    explore.publish("plan", Path, Quality.LATCHED).send(Path(0, "map", points))
    explore.publish("current_goal", StampedPose, Quality.LATCHED).send(StampedPose(0, "map", Pose2(2.0, 0.0, 0.0)))
    bus.run(0.1)
    assert topics.frontiers == (FrontierPoint(1.0, 0.2, blocked=True),)
    snapshot = topics.add(RobotSnapshot())
    assert snapshot.goal.pose == Pose2(2.0, 0.0, 0.0)
    assert snapshot.path is not None
    assert snapshot.path.tolist() == points[:, :2].tolist()
