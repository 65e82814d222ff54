"""What pages see of a robot on a bus: its pose, map, scan and state, and only as much as their server takes."""

import math
import struct
from pathlib import Path

import numpy as np
import pytest
from tests.ur_nodes.web.robot_world import DrivingPage, Outlet, RobotWorld

from ur.web.wire.frames import NOTHING_RUNS, Kind, Layer, key_of
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryParameters
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery, Map, PoseEstimate, Range, Scan, Transform
from ur_nodes.ports.values import Path as PathValue
from ur_nodes.web.robot_endpoint import RobotSession
from ur_nodes.web.view_state import list_sources

HERE = Pose2(0.0, 0.0, 0.0).in_space()
GRID = Grid(np.zeros((300, 600), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))


@pytest.fixture
def world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RobotWorld:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setenv("ROS_MASTER_URI", "http://robot:1")
    return RobotWorld()


def keys(world: RobotWorld, seconds: float) -> list[tuple[int, int]]:
    """Kind and layer of the frames that are sent from now on."""
    before = len(world.view.frames)
    world.bus.run(seconds)
    return [key_of(each)[:2] for each in world.view.frames[before:]]


def publish_pose(world: RobotWorld, x: float) -> None:
    place = Pose2(x, 0.0, 0.0).in_space()
    world.robot.transforms.send(
        Transform(world.bus.now, "map", "odom", HERE), Transform(world.bus.now, "odom", "base_footprint", place)
    )


@pytest.mark.parametrize("base", ["base_footprint", "base_link"])
def test_robot_without_a_map_is_shown_where_its_odometry_has_it(world: RobotWorld, base: str) -> None:
    scans = world.robot.publish("scan", Scan)
    world.end.on_view({"viewers": 1})
    for _ in range(5):
        here = Pose2(2.0, 1.0, 0.0).in_space()
        world.robot.transforms.send(Transform(world.bus.now, "odom", base, here))
        scans.send(Scan(world.bus.now, base, 0.0, 0.1, 0.1, 8.0, np.array([3.0], np.float32)))
        world.bus.run(0.2)
    shown = [each for each in world.view.frames if key_of(each)[0] == Kind.POSE][-1]
    assert struct.unpack_from("<2f", shown, len(shown) - 28) == (2.0, 1.0)
    hits = [each for each in world.view.frames if key_of(each)[:2] == (Kind.POINTS, Layer.SCAN)][-1]
    assert struct.unpack("<2f", hits[-12:-4]) == (5.0, 1.0)


def test_pose_is_sent_fifteen_times_a_second_while_a_page_is_open_and_twice_a_second_else(world: RobotWorld) -> None:
    world.end.on_view({"viewers": 1})
    sent = keys(world, 2.0)
    assert 29 <= sent.count((Kind.POSE, 0)) <= 31
    assert 14 <= sent.count((Kind.POINTS, Layer.SCAN)) <= 16
    world.end.on_view({"viewers": 0})
    sent = keys(world, 4.0)
    assert 7 <= sent.count((Kind.POSE, 0)) <= 10
    assert (Kind.POINTS, Layer.SCAN) not in sent
    world.end.on_view({"viewers": 1})
    assert (Kind.POSE, 0) in keys(world, 0.0), "the first page does not wait"


def test_pose_out_of_all_measure_is_no_pose(world: RobotWorld) -> None:
    world.end.on_view({"viewers": 1})
    publish_pose(world, 1e39)
    world.bus.run(1.0)
    pose = next(each for each in reversed(world.view.frames) if key_of(each)[0] == Kind.POSE)
    assert math.isnan(struct.unpack_from("<f", pose, 6)[0])


def test_map_scan_and_plan_are_sent_where_they_are_in_the_map(world: RobotWorld) -> None:
    world.end.on_view({"viewers": 1})
    publish_pose(world, 2.0)
    world.robot.transforms.send(Transform(0, "base_footprint", "laser", HERE, fixed=True))
    world.bus.run(0.5)
    ranges = np.full(5000, 1.0, np.float32)
    scans = world.robot.publish("scan", Scan)
    maps = world.robot.publish("map", Map, Quality.LATCHED)
    maps.send(Map(0, "map", GRID))
    scans.send(Scan(world.bus.now, "laser", 0.0, 0.001, 0.1, 12.0, ranges))
    sent = keys(world, 1.0)
    assert sent.count((Kind.GRID, Layer.MAP)) == 1
    assert sent.count((Kind.TILE, Layer.MAP)) == 6
    scan = next(each for each in reversed(world.view.frames) if key_of(each)[:2] == (Kind.POINTS, Layer.SCAN))
    assert struct.unpack_from("<2f", scan, 6) == pytest.approx((3.0, 0.0), abs=0.01)
    assert len(scan) <= 14 + 4 * 2000
    changed = GRID.values.copy()
    changed[0, 0] = 100
    maps.send(Map(0, "map", Grid(changed, GRID.resolution, GRID.origin)))
    assert keys(world, 1.0).count((Kind.TILE, Layer.MAP)) == 1


def test_plan_is_sent_while_its_goal_is_driven_to(world: RobotWorld) -> None:
    world.end.on_view({"viewers": 1})
    page, plans = DrivingPage(world), world.robot.publish("move_base/NavfnROS/plan", PathValue)
    page.ask("goal", x=1.0, y=2.0, yaw=0.5)
    world.bus.run(1.0)
    plans.send(PathValue(0, "map", np.zeros((3, 3))))
    assert (Kind.POINTS, Layer.PLAN) in keys(world, 1.0)
    page.ask("cancel")
    assert (Kind.POINTS, Layer.PLAN) in keys(world, 1.0), "it is taken away"


def test_server_that_is_slow_gets_the_newest_state_later_and_no_queue(world: RobotWorld) -> None:
    world.end.on_view({"viewers": 1})
    world.bus.run(1.0)
    world.view.busy = True
    assert keys(world, 5.0) == []
    batteries = world.robot.publish("battery_state", Battery)
    batteries.send(Battery(0, 12.34, -1.0, 1.0, 2.0, 0.5))
    assert keys(world, 1.0) == []
    world.view.busy = False
    world.bus.run(1.0)
    assert world.view.newest(Kind.STATE)["battery"] == {"share": 0.5, "volts": 12.3, "charging": False}


def test_state_is_sent_when_it_has_changed(world: RobotWorld) -> None:
    world.end.on_view({"viewers": 1})
    world.bus.run(4.0)
    assert (Kind.STATE, 0) not in keys(world, 4.0)
    state = world.view.newest(Kind.STATE)
    assert state["robot"]["base"] == "stage"
    assert state["sources"][0] == "joystick"
    assert state["lease"]["state"] == "free"
    assert any("the map" in each for each in state["missing"])
    batteries = world.robot.publish("battery_state", Battery)
    batteries.send(Battery(0, float("nan"), -1.0, 1.0, 2.0, float("nan"), charging=True))
    assert keys(world, 1.0).count((Kind.STATE, 0)) == 1
    assert world.view.newest(Kind.STATE)["battery"] == {"share": None, "volts": None, "charging": True}


def test_robot_whose_nodes_have_ended_is_reported_once_and_the_next_one_gets_a_page_that_knows_nothing() -> None:
    bus, frames = Bus(), Outlet()
    node = bus.node("web_vm_17")
    bus.node("web_data_vm_18"), bus.node("rosout"), bus.node("_ros2cli_daemon_0")
    end = RobotSession(node, frames, Outlet())
    end.on_view({"viewers": 1})
    bus.run(1.0)
    assert NOTHING_RUNS not in frames.frames, "one look is not enough: nodes are discovered one after the other"
    bus.run(2.0)
    assert frames.frames.pop() == NOTHING_RUNS
    before = len(frames.frames)
    bus.run(6.0)
    assert len(frames.frames) == before
    robot = bus.node("web_server")  # a user's
    bus.run(3.0)
    assert [each for each in frames.frames[before:] if key_of(each)[0] == Kind.STATE], "it is sent again"
    end.on_view({"viewers": 0})
    robot.end("the program ended")
    bus.run(6.0)
    assert frames.frames.pop() == NOTHING_RUNS
    assert node.ended is None
    bus.node("robot")
    bus.run(3.0)
    assert node.ended == "another robot has started"


def test_layers_that_pages_show_are_found_by_the_types_of_their_topics(world: RobotWorld) -> None:
    sonars = world.robot.publish("sonars", Range, type_name="sensor_msgs/Range")
    world.robot.transforms.send(Transform(0, "map", "sonar", HERE, fixed=True))
    world.end.on_view({"viewers": 1, "layers": [Layer.SONARS]})
    world.bus.run(3.0)
    sonars.send(Range(0, "sonar", 0.5, 0.4, 0.1, 3.0))
    world.bus.run(1.0)
    assert world.view.newest(Kind.OVERLAY, Layer.SONARS) == {"cones": [[0.0, 0.0, 0.0, 0.5, 0.4, 1]]}
    world.end.on_view({"viewers": 1, "layers": []})
    world.bus.run(1.0)
    assert world.view.newest(Kind.OVERLAY, Layer.SONARS) == {}
    assert sonars.subscribers() == 0


@pytest.mark.parametrize(("variance", "spread"), [(0.02, 0.2), (float("inf"), None), (float("nan"), None)])
def test_spread_of_the_pose_is_sent_where_it_is_a_number(
    world: RobotWorld, variance: float, spread: float | None
) -> None:
    world.end.on_view({"viewers": 1})
    poses = world.robot.publish("amcl_pose", PoseEstimate, Quality.LATCHED)
    poses.send(PoseEstimate(0, "map", Pose2(0.0, 0.0, 0.0), np.diag([variance, variance, 0.1])))
    world.bus.run(1.0)
    assert world.view.newest(Kind.STATE)["spread"] == spread


def test_sources_that_cannot_be_read_are_asked_for_again(world: RobotWorld, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_self: object, _name: str) -> object:
        raise ConnectionResetError("the master was restarted")

    frames = Outlet()
    end = RobotSession(world.bus.node("web_again"), frames, Outlet())
    end.on_view({"viewers": 1})
    with monkeypatch.context() as patch:
        patch.setattr(MemoryParameters, "get", fail)
        world.bus.run(1.0)
    assert frames.newest(Kind.STATE)["sources"] == []
    world.robot.publish("cmd_vel_mux/speed_limit_in_force", float, Quality.LATCHED).send(60.0)
    world.bus.run(1.0)
    assert frames.newest(Kind.STATE)["sources"][0] == "joystick"


def test_sources_are_listed_by_urgency_and_what_is_no_source_is_left_out() -> None:
    assert list_sources([{"name": "b", "priority": 1}, {"name": "a", "priority": 9}, {"name": 3}]) == ["a", "b"]
    for value in (None, 3, "x", ["x"], {"name": "a"}):
        assert list_sources(value) == []
