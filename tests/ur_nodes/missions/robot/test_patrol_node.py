"""The node `patrol` on a bus, with the real mux, a navigation that obeys the test, and clients that send requests."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.fakes.navigation import FakeNavigation

from ur.source.foreign.yaml_text import load_yaml
from ur.source.project import launch_library
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryParameters
from ur_nodes.missions.robot.patrol_node import start
from ur_nodes.motion import cmd_vel_mux_node
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.motion.lease.view import Identity
from ur_nodes.navigation.goals.goal_claim import has_any_heading, read_claim
from ur_nodes.ports.node import SECOND
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Map, Result, Transform

SOURCES = load_yaml((launch_library() / "n_cmd_vel_mux/params/sources.yaml").read_text(encoding="utf-8"))
SOFA, HALL = {"name": "sofa", "x": 1.0, "y": 0.0, "yaw": 0.5}, {"name": "hall", "x": 2.0, "y": 2.0}


class PatrolStage:
    """The robot: mux, navigation, patrol; and a laptop that may drive."""

    def __init__(self, **parameters: Any) -> None:
        self.bus = Bus()
        self.bus.load_parameters("/cmd_vel_mux", {"base": "stage", **SOURCES})
        self.bus.parameters |= {f"/patrol/{name}": value for name, value in parameters.items()}
        self.mux = self.bus.node("cmd_vel_mux")
        self.mux.facts.simulated_time = False
        cmd_vel_mux_node.start(self.mux)
        self.navigation = FakeNavigation(self.bus.node("move_base"))
        self.client = self.bus.node("client")
        self.laptop = LeaseClient(
            self.bus.node("laptop"), "cmd_vel_mux", identity=Identity("ab12", "laptop", "keys", "watch")
        )
        self.statuses: list[dict[str, Any]] = []
        self.client.subscribe("patrol/status", str, lambda text: self.statuses.append(json.loads(text)), Quality.EVERY)
        self._requests = self.client.publish("patrol/request", str, Quality.EVERY)
        self.start()

    def start(self) -> None:
        self.patrol = self.bus.node("patrol")
        start(self.patrol)
        self.bus.run(1.0)

    @property
    def status(self) -> dict[str, Any]:
        return self.statuses[-1]

    @property
    def lease(self) -> tuple[str, str]:
        view = self.laptop.view()
        return view.state, view.holder

    def ask(self, action: str, places: list[Any] | None = None, **values: Any) -> str:
        """Send a request; return why it is refused."""
        route = {} if places is None else {"places": places, "wait": 0.5}
        id = f"request {len(self.statuses)}"
        self._requests.send(json.dumps({"do": action, "id": id, **route, **values}))
        assert self.bus.run_until(lambda: (self.status["answer"] or {}).get("id") == id, 5.0)
        return str(self.status["answer"]["problem"])

    def reaches(self, state: str, seconds: float = 10.0) -> bool:
        return self.bus.run_until(lambda: self.status["state"] == state, seconds)

    def call(self, service: str) -> None:
        got: list[Result] = []
        self.client.call(service, Trigger(), got.append)
        assert self.bus.run_until(lambda: bool(got), 5.0)


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    monkeypatch.setenv("ROS_MASTER_URI", "http://robot:1")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    return tmp_path


@pytest.fixture
def stage() -> PatrolStage:
    return PatrolStage()


def test_patrol_drives_to_each_place_waits_there_and_is_done_after_the_last(stage: PatrolStage) -> None:
    assert stage.status["state"] == "idle"
    assert stage.ask("start", [SOFA, HALL]) == ""
    assert stage.reaches("driving")
    assert stage.lease == ("held", "patrol")
    goal = stage.navigation.newest.goal
    assert goal.target.pose == pytest.approx((1.0, 0.0, 0.5))
    assert goal.target.frame == "map"
    claim = read_claim(goal.id)
    assert claim is not None
    assert claim.client == "patrol.patrol"
    assert not has_any_heading(goal.id)
    stage.navigation.newest.succeed("")
    assert stage.reaches("waiting")
    before = stage.bus.now
    assert stage.bus.run_until(lambda: len(stage.navigation.goals) == 2, 5.0)
    assert 0.4 * SECOND <= stage.bus.now - before <= 0.8 * SECOND
    stage.navigation.newest.succeed("")
    assert stage.reaches("done")
    assert [each["state"] for each in stage.statuses if not each["answer"] or each["state"] != "idle"] == [
        "idle", "starting", "starting", "driving", "waiting", "driving", "waiting", "done",
    ]  # fmt: skip
    stage.bus.run(1.0)
    assert stage.lease[0] == "free"
    assert ("info", "patrol: drives to hall (2 of 2)") in stage.patrol.lines


def test_loop_begins_again_with_the_first_place(stage: PatrolStage) -> None:
    stage.ask("start", [SOFA, HALL], loop=True)
    for count in range(1, 4):
        assert stage.bus.run_until(lambda count=count: len(stage.navigation.goals) == count, 5.0)  # type: ignore[misc]
        stage.navigation.newest.succeed("")
    stage.bus.run(0.2)
    assert (stage.status["state"], stage.status["rounds"]) == ("waiting", 1)
    assert stage.navigation.newest.goal.target.pose.x == 1.0


def test_place_without_heading_is_driven_to_straight_from_the_robot(stage: PatrolStage) -> None:
    stage.client.transforms.send(Transform(stage.bus.now, "map", "base_footprint", Pose2(2.0, 1.0, 0.0).in_space()))
    stage.bus.run(0.1)
    stage.ask("start", [HALL])
    assert stage.reaches("driving")
    goal = stage.navigation.newest.goal
    assert goal.target.pose == pytest.approx((2.0, 2.0, math.pi / 2))
    assert has_any_heading(goal.id)


def test_patrol_is_paused_resumed_and_ended_on_request(stage: PatrolStage) -> None:
    assert stage.ask("resume") == "no patrol is paused"
    stage.ask("start", [SOFA, HALL])
    assert stage.reaches("driving")
    first = stage.navigation.newest
    assert stage.ask("pause") == ""
    assert (stage.status["state"], stage.status["reason"]) == ("paused", "on request")
    stage.bus.run(1.0)
    assert stage.navigation.cancelled == [first.goal.id]
    assert stage.lease[0] == "free"
    assert stage.ask("resume") == ""
    assert stage.reaches("driving")
    assert stage.navigation.newest is not first
    assert stage.navigation.newest.goal.target.pose.x == 1.0
    assert stage.ask("end") == ""
    assert stage.status["state"] == "ended"
    stage.bus.run(0.2)
    assert stage.navigation.cancelled[-1] == stage.navigation.newest.goal.id


def test_emergency_stop_pauses_the_patrol_and_refuses_the_next_start(stage: PatrolStage) -> None:
    stage.ask("start", [SOFA])
    assert stage.reaches("driving")
    stage.call("cmd_vel_mux/stop")
    assert stage.reaches("paused", 0.5)
    assert stage.status["reason"] == "emergency stop"
    assert stage.navigation.cancelled == [stage.navigation.newest.goal.id]
    assert stage.ask("resume") == "the emergency stop is on, release it first"
    stage.call("cmd_vel_mux/release")
    stage.bus.run(2.0)
    assert stage.status["state"] == "paused", "nothing starts by itself"


def test_take_over_pauses_the_patrol_and_names_who_drives(stage: PatrolStage) -> None:
    stage.ask("start", [SOFA])
    assert stage.reaches("driving")
    stage.laptop.take_over()
    assert stage.reaches("paused", 2.0)
    assert stage.status["reason"] == "laptop took over"
    assert "laptop drives since" in stage.ask("resume")
    stage.bus.run(1.0)
    assert stage.lease == ("held", "laptop")


def test_take_over_that_is_shorter_than_a_look_at_it_pauses_the_patrol(stage: PatrolStage) -> None:
    stage.ask("start", [SOFA])
    assert stage.reaches("driving")
    stage.laptop.take_over()
    assert stage.bus.run_until(lambda: stage.laptop.view().mine, 1.0)
    stage.laptop.release(final=False)
    assert stage.reaches("paused", 1.0)
    assert stage.status["reason"] == "laptop took over"


def test_driver_who_starts_the_patrol_hands_the_lease_over(stage: PatrolStage) -> None:
    stage.laptop.acquire()
    assert stage.bus.run_until(lambda: stage.laptop.view().mine, 3.0)
    challenge = stage.laptop.link.newest(1.0)
    assert challenge is not None
    answers = list(divmod(challenge, SECOND))
    assert stage.ask("start", [SOFA], client="ab12", name="laptop", answers=answers) == ""
    assert stage.reaches("driving", 3.0)
    assert stage.lease == ("held", "patrol")


def test_old_and_latched_requests_start_nothing(stage: PatrolStage) -> None:
    challenge = stage.laptop.link.newest(1.0)
    assert challenge is not None
    stage.bus.run(1.5)
    answers = list(divmod(challenge, SECOND))
    assert "arrived late" in stage.ask("start", [SOFA], client="ab12", answers=answers)
    (listener,) = stage.bus.topics["/patrol/request"].subscribers
    old = json.dumps({"do": "start", "id": "kept", "places": [SOFA]})
    listener.deliver(old, "/old", True)  # as on ROS 1, where all subscribers get what a topic has kept
    stage.bus.run(0.1)
    assert "a latched request may be old" in stage.status["answer"]["problem"]
    assert not stage.navigation.goals


def test_text_that_is_no_request_is_reported_and_ignored(stage: PatrolStage) -> None:
    stage._requests.send("start!")
    stage.bus.run(0.1)
    assert stage.patrol.lines[-1] == ("warn", "a request for a patrol is ignored, expected JSON")


@pytest.mark.parametrize(
    ("end", "reason"),
    [("abort", "sofa was not reached: a wall"), ("cancel", "a wall")],
)
def test_goal_that_ends_elsewhere_pauses_the_patrol_with_the_reason(stage: PatrolStage, end: str, reason: str) -> None:
    stage.ask("start", [SOFA])
    assert stage.reaches("driving")
    getattr(stage.navigation.newest, end)("a wall")
    assert stage.reaches("paused", 0.5)
    assert stage.status["reason"] == reason


def test_start_without_navigation_is_given_up(stage: PatrolStage) -> None:
    stage.navigation.node.end("test")
    assert stage.ask("start", [SOFA]) == ""
    assert stage.reaches("paused", 6.0)
    assert "navigation and mux do not answer" in stage.status["reason"]


def test_place_that_takes_too_long_pauses_the_patrol() -> None:
    stage = PatrolStage(step_limit=3.0)
    stage.ask("start", [SOFA])
    assert stage.reaches("paused", 5.0)
    assert stage.status["reason"] == "sofa was not reached within 3 s"


def test_node_that_ends_cancels_its_goal_and_frees_the_lease(stage: PatrolStage) -> None:
    stage.ask("start", [SOFA])
    assert stage.reaches("driving")
    stage.patrol.end("done")
    stage.bus.run(0.5)
    assert stage.navigation.cancelled == [stage.navigation.newest.goal.id]
    assert stage.lease[0] == "free"


def test_goal_of_a_node_that_was_killed_is_cancelled_by_the_next(stage: PatrolStage) -> None:
    stage.ask("start", [SOFA])
    assert stage.reaches("driving")
    stage.patrol._at_end.clear()
    stage.patrol.end("killed")
    stage.start()
    assert stage.navigation.cancelled == [stage.navigation.newest.goal.id]
    assert stage.status["state"] == "idle"


def test_places_are_looked_up_by_name_in_the_file_of_the_keeper(stage: PatrolStage, home: Path) -> None:
    file = home / "places.yaml"
    WaypointStore(file).remember("kitchen", Pose2(3.0, 1.0, 0.0))
    stage.bus.parameters["/keyboard_navigate/waypoints_file"] = str(file)
    assert "unknown waypoint 'attic'" in stage.ask("start", ["attic"])
    assert stage.ask("start", ["kitchen"]) == ""
    assert stage.reaches("driving")
    assert stage.navigation.newest.goal.target.pose == pytest.approx((3.0, 1.0, 0.0))


def test_places_of_a_map_without_a_name_need_the_map(stage: PatrolStage) -> None:
    assert stage.ask("start", ["kitchen"]) == "expected a map, whose waypoints have names"
    maps = stage.bus.node("map_server").publish("map", Map, Quality.LATCHED)
    maps.send(Map(0, "map", Grid(np.zeros((2, 2), np.int8), 0.1, Pose2(0.0, 0.0, 0.0))))
    assert "unknown waypoint 'kitchen'" in stage.ask("start", ["kitchen"])
    stage.bus.parameters["/keyboard_navigate/save_service"] = "save"
    assert "saved under a name" in stage.ask("start", ["kitchen"])


def test_requests_keep_their_order_while_places_are_looked_up(stage: PatrolStage) -> None:
    for action, route in (("start", {"places": ["kitchen"]}), ("end", {}), ("start", {"places": [SOFA]})):
        stage._requests.send(json.dumps({"do": action, "id": action, **route}))
    stage.bus.run(3.0)
    ids = [each["answer"]["id"] for each in stage.statuses if each["answer"]]
    assert list(dict.fromkeys(ids)) == ["start", "end"]
    assert stage.status["state"] == "driving"
    assert stage.status["answer"]["id"] == "start"


def test_flood_of_requests_does_not_grow_and_the_newest_still_counts(stage: PatrolStage) -> None:
    for number in range(50):
        stage._requests.send(json.dumps({"do": "start", "id": f"{number}", "places": ["kitchen"]}))
        stage.bus.run(0.01)
    stage._requests.send(json.dumps({"do": "end", "id": "last"}))
    stage.bus.run(25.0)
    answers = {each["answer"]["id"]: each["answer"]["problem"] for each in stage.statuses if each["answer"]}
    assert answers["1"] == "expected fewer requests at once"
    assert answers["49"] == "expected a map, whose waypoints have names"
    assert answers["last"] == ""


def test_parameters_that_cannot_be_read_refuse_a_request_and_the_patrol_goes_on(
    stage: PatrolStage, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_self: object, _name: str) -> object:
        raise ConnectionResetError("the master was restarted")

    with monkeypatch.context() as patch:
        patch.setattr(MemoryParameters, "get", fail)
        assert stage.ask("start", ["kitchen"]) == "expected a parameter server that answers"
    assert stage.ask("start", [SOFA]) == ""
    assert stage.reaches("driving")
