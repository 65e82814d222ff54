"""The node `move_base` on a bus, with a robot made of mathematics."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.ur_nodes.navigation.robot_stage import BLIND, RobotStage

from ur.source.diagnostic import UserError
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.navigation.move_base_node import start
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskPath, ClearCostmap, Silent
from ur_nodes.ports.values import Map, MapUpdate, Outline, Path, StampedPose


@pytest.fixture
def robot() -> RobotStage:
    return RobotStage()


def test_goal_is_reached_and_the_node_is_silent_afterwards(robot: RobotStage) -> None:
    goal = robot.send(0.8, 0.4, yaw=1.57)
    assert robot.end(goal) == ("succeeded", "goal reached")
    assert robot.away(0.8, 0.4) < 0.1
    assert abs(robot.pose.yaw - 1.57) < 0.09
    robot.bus.run(0.2)
    assert robot.rests()
    assert robot.reports[-1].frame == "map"
    assert robot.reports[-1].pose == pytest.approx(robot.pose, abs=0.1)


def test_robot_at_rest_begins_a_goal_before_the_next_control_period(robot: RobotStage) -> None:
    robot.bus.run(0.5)
    robot.send(3.0, 0.0)
    robot.bus.run(0.03)
    assert robot.command[0] > 0.0


def test_commands_come_at_their_rate_while_the_robot_drives(robot: RobotStage) -> None:
    robot.send(3.0, 0.0)
    assert robot.starts_moving()
    before = robot.commands
    robot.bus.run(2.0)
    assert robot.commands - before == pytest.approx(60, abs=2)


def test_displays_are_published_to_who_listens(robot: RobotStage) -> None:
    got: dict[str, list[object]] = {}
    for topic, kind in {
        "global_costmap/costmap": Map,
        "global_costmap/costmap_updates": MapUpdate,
        "local_costmap/costmap": Map,
        "global_costmap/footprint": Outline,
        "local_costmap/footprint": Outline,
        "NavfnROS/plan": Path,
        "DWAPlannerROS/global_plan": Path,
        "DWAPlannerROS/local_plan": Path,
        "current_goal": StampedPose,
    }.items():
        robot.client.subscribe(f"move_base/{topic}", kind, got.setdefault(topic, []).append, Quality.EVERY)
    robot.bus.run(1.0)  # the whole costmap is published first
    robot.occupied[20:25, 10:15] = True  # something that the map does not show
    robot.end(robot.send(0.8, 0.4))
    assert all(got.values()), {topic: len(values) for topic, values in got.items()}
    costmap, local = got["global_costmap/costmap"], got["local_costmap/costmap"][0]
    assert len(costmap) == 1, "the whole once, then changes"
    assert isinstance(costmap[0], Map)
    assert isinstance(local, Map)
    assert costmap[0].grid.values.shape == (84, 124)
    assert (costmap[0].frame, local.frame) == ("map", "odom")


def test_robot_stops_when_its_goal_is_cancelled(robot: RobotStage) -> None:
    goal = robot.send(-0.8, -1.0)
    assert robot.starts_moving()
    robot.cancel(goal)
    assert robot.end(goal, 0.1) == ("cancelled", "cancelled")
    assert robot.stops_moving()
    assert robot.rests()


def test_new_goal_replaces_the_old_one(robot: RobotStage) -> None:
    old = robot.send(3.0, 0.0)
    assert robot.starts_moving()
    new = robot.send(0.0, 0.0)
    assert robot.end(old, 0.1) == ("cancelled", "a new goal has replaced this one")
    assert robot.end(new)[0] == "succeeded"
    assert robot.away(0.0, 0.0) < 0.1


@pytest.mark.parametrize(
    ("x", "yaw", "frame", "reason"),
    [
        (1.5, 0.0, "map", "the goal (1.50, -1.00) is in a wall"),
        (50.0, 0.0, "map", "outside the map"),
        (0.5, math.nan, "map", "not a unit quaternion"),
        (math.nan, 0.0, "map", "not finite"),
        (0.5, 0.0, "", "the goal has no frame_id, expected map"),
        (0.5, 0.0, "moon", "the goal is in the frame moon: no transform"),
    ],
)
def test_goal_that_cannot_be_reached_ends_with_the_reason(
    robot: RobotStage, x: float, yaw: float, frame: str, reason: str
) -> None:
    state, text = robot.end(robot.send(x, -1.0, yaw, frame))
    assert state == "aborted"
    assert reason in text
    robot.bus.run(0.2)
    assert robot.rests()


def test_plans_are_made_without_driving(robot: RobotStage) -> None:
    here, there = StampedPose(0, "", Pose2(0.0, 0.0, math.nan)), StampedPose(0, "map", Pose2(3.0, -1.0, 0.0))
    found = robot.ask("move_base/make_plan", AskPath(here, there, 0.0)).value
    assert isinstance(found, Path)
    assert found.poses[-1, :2] == pytest.approx((3.0, -1.0), abs=0.05)
    middle = found.poses[abs(found.poses[:, 0] - 1.5) < 0.05]
    assert ((middle[:, 1] > 0.4) & (middle[:, 1] < 1.3)).all(), "through the door"
    in_wall = StampedPose(0, "map", Pose2(1.5, -1.0, 0.0))
    nowhere = robot.ask("move_base/make_plan", AskPath(here, in_wall, 0.0)).value
    assert isinstance(nowhere, Path)
    assert len(nowhere.poses) == 0
    assert robot.move_base.lines[-1][1].startswith("make_plan: the goal (1.50, -1.00) is in a wall")
    assert robot.commands == 0


def test_obstacles_are_forgotten_on_request(robot: RobotStage) -> None:
    maps: list[Map] = []
    robot.client.subscribe("move_base/local_costmap/costmap", Map, maps.append)
    robot.occupied[45:50, 45:50] = True
    robot.bus.run(1.5)
    seen = int((maps[-1].grid.values == 100).sum())
    robot.seeing = False
    robot.bus.run(0.6)
    assert robot.ask("move_base/clear_costmaps", Silent()).success
    assert robot.ask("global_costmap/clear_entirely_global_costmap", ClearCostmap()).success
    assert robot.ask("local_costmap/clear_entirely_local_costmap", ClearCostmap()).success
    robot.bus.run(1.5)
    assert int((maps[-1].grid.values == 100).sum()) < seen / 2


@pytest.mark.parametrize(("input_", "reason"), [("seeing", "no scan on /scan for"), ("moving_frames", "no odometry: ")])
def test_robot_stops_and_gives_up_when_an_input_falls_silent(robot: RobotStage, input_: str, reason: str) -> None:
    goal = robot.send(1.0, -1.5)
    assert robot.starts_moving()
    setattr(robot, input_, False)
    state, text = robot.end(goal)
    assert state == "aborted"
    assert reason in text
    assert robot.away(1.0, -1.5) > 0.2
    assert robot.stops_moving()


def test_emergency_stop_ends_the_goal_for_good(robot: RobotStage) -> None:
    goal = robot.send(3.0, 0.0)
    assert robot.starts_moving()
    robot.stops.send(True)
    assert robot.end(goal, 0.1) == ("aborted", "emergency stop")
    assert robot.stops_moving()
    refused = robot.send(0.0, 0.0)
    assert robot.end(refused, 0.1) == ("aborted", "emergency stop is on; release it first")
    robot.stops.send(False)
    assert robot.rests(), "it does not drive off after the release"
    assert robot.end(robot.send(0.0, 0.0))[0] == "succeeded"


def test_robot_keeps_out_of_zones_that_appear(robot: RobotStage) -> None:
    masks = robot.node.publish("keepout_filter_mask", Map, Quality.LATCHED)
    mask = np.zeros(robot.grid.values.shape, np.int8)
    mask[:, 70:] = 100  # the right room
    masks.send(Map(0, "map", Grid(mask, robot.grid.resolution, robot.grid.origin)))
    robot.bus.run(0.5)
    state, text = robot.end(robot.send(3.0, -1.0))
    assert (state, text) == ("aborted", "the goal (3.00, -1.00) is in a keep-out zone")
    masks.send(Map(0, "map", Grid(np.zeros_like(mask), robot.grid.resolution, robot.grid.origin)))
    assert robot.end(robot.send(3.0, -1.0))[0] == "succeeded"


def test_new_map_is_used_while_the_robot_drives(robot: RobotStage) -> None:
    goal = robot.send(3.0, -1.0)
    assert robot.starts_moving()
    walls = robot.grid.values.copy()
    walls[:, 61:63] = 100  # the door is shut
    robot.maps.send(Map(0, "map", Grid(walls, robot.grid.resolution, robot.grid.origin)))
    robot.occupied[:] = walls >= 65
    state, text = robot.end(goal)
    assert state == "aborted"
    assert "nothing wide enough for the robot leads from" in text


def test_robot_stops_when_a_map_cannot_be_read_until_the_next_one(robot: RobotStage) -> None:
    goal = robot.send(3.0, 0.0)
    assert robot.starts_moving()
    robot.bus.spoil("/map", "map of 2 x 2 cells with 3 values, expected one value per cell")
    assert robot.stops_moving()
    assert robot.move_base.lines[-1][1] == "stopped: map of 2 x 2 cells with 3 values, expected one value per cell"
    robot.bus.run(0.3)
    robot.maps.send(Map(robot.bus.now, "map", robot.grid))
    assert robot.end(goal)[0] == "succeeded"


def test_robot_is_stopped_when_the_node_ends(robot: RobotStage) -> None:
    robot.send(3.0, 0.0)
    assert robot.starts_moving()
    robot.move_base.end("the test is over")
    robot.bus.run(0.02)
    assert robot.command == (0.0, 0.0)


def test_without_a_scan_the_robot_drives_on_the_map_alone() -> None:
    robot = RobotStage(parameters=BLIND)
    robot.seeing = False
    state, text = robot.end(robot.send(3.0, -1.0, yaw=1.57))  # in the other room, through the door
    assert state == "succeeded", text
    assert robot.away(3.0, -1.0) < 0.1


def test_without_a_scan_the_robot_goes_round_what_a_sonar_hears() -> None:
    robot = RobotStage(parameters=BLIND)
    robot.seeing, robot.pillar = False, (0.0, 0.9)
    state, text = robot.end(robot.send(0.0, 1.6, yaw=1.57), 90.0)
    assert state == "succeeded", text
    assert robot.nearest > 0.19  # the robot's half width


def test_parameter_that_makes_no_sense_is_named() -> None:
    bus = Bus()
    bus.load_parameters("/move_base", {"controller_frequency": "often"})
    with pytest.raises(UserError, match="parameter /move_base/controller_frequency: 'often', expected a number"):
        start(bus.node("move_base"))
