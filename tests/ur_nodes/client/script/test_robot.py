"""Programs of users on a bus, with simulator, mux, localisation and navigation."""

import math
import re
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest
from tests.ur_nodes.first_drive.drive import FirstDrive

from ur_nodes.client import Interrupted, Lost, Refused, Robot, TakenOver
from ur_nodes.client.driver_text import describe_driver
from ur_nodes.memory.bus import Bus
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.motion.lease.view import Identity
from ur_nodes.motion.ramp import axes_of
from ur_nodes.ports.services import Trigger


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> FirstDrive:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))  # where the mux keeps its lease
    return FirstDrive()


def connect(stage: FirstDrive, name: str = "script") -> Robot:
    return Robot(name, node=stage.bus.node(name), wait=stage.bus.run_until)


@pytest.fixture
def robot(stage: FirstDrive) -> Iterator[Robot]:
    with connect(stage) as robot:
        yield robot


def other_client(stage: FirstDrive) -> LeaseClient:
    """A client of another computer."""
    return LeaseClient(stage.bus.node("other"), "cmd_vel_mux", identity=Identity("other", "laptop2", "web"))


def interrupt() -> None:
    raise KeyboardInterrupt


def speed(stage: FirstDrive) -> float:
    return abs(stage.truth.twist.forward) + abs(stage.truth.twist.turn)


def test_robot_goes_to_a_place_and_says_where_it_is(stage: FirstDrive, robot: Robot) -> None:
    start = robot.pose()
    pose = robot.go_to(start.x + 0.5, start.y, 90)
    true = stage.truth.pose
    assert math.hypot(true.x - start.x - 0.5, true.y - start.y) < 0.3
    assert math.hypot(true.x - pose.x, true.y - pose.y) < 0.2
    assert true.yaw == pytest.approx(math.pi / 2, abs=0.3)


def test_sensors_are_values_with_units(stage: FirstDrive, robot: Robot) -> None:
    assert robot.map().grid.resolution == pytest.approx(stage.grid().resolution)
    scan = robot.scan()
    assert scan.range_max > robot.nearest() > scan.range_min
    assert robot.nearest(20.0) >= robot.nearest()


def test_sensor_that_the_robot_has_not_is_lost(robot: Robot) -> None:
    with pytest.raises(Lost, match="no packedpicture on /upper_camera/compressed"):
        robot.picture("upper_camera/compressed")


def test_drive_ends_in_time_and_leaves_the_robot_at_rest(stage: FirstDrive, robot: Robot) -> None:
    before = stage.truth.pose
    robot.drive(0.0, 0.5, 1.0)
    stage.bus.run(0.6)
    assert stage.truth.pose.yaw - before.yaw == pytest.approx(0.5, abs=0.2)
    assert speed(stage) < 0.01


def test_robot_is_at_rest_soon_after_the_program_hangs(stage: FirstDrive) -> None:
    speeds: list[float] = []

    def hang(condition: Callable[[], bool], seconds: float) -> bool:
        stage.bus.run_until(lambda: condition() or speed(stage) > 0.3, seconds)
        if speed(stage) > 0.3 and not speeds:
            stage.bus.run(0.3)
            speeds.append(speed(stage))
            stage.bus.run(0.5)
        return stage.bus.run_until(condition, seconds)

    with Robot("script", node=stage.bus.node("script"), wait=hang) as robot, pytest.raises(Lost, match="hung"):
        robot.drive(0.0, 0.5, 30.0)
    assert speeds[0] < 0.02


def test_goal_is_held_when_the_program_hangs_and_screens_say_so(stage: FirstDrive) -> None:
    speeds: list[float] = []
    lines: list[str] = []
    screen = other_client(stage)

    def hang(condition: Callable[[], bool], seconds: float) -> bool:
        stage.bus.run_until(lambda: condition() or speed(stage) > 0.1, seconds)
        if speed(stage) > 0.1 and not speeds:
            stage.bus.run(3.5)
            speeds.append(speed(stage))
            lines.append(describe_driver(screen.view()))
        return stage.bus.run_until(condition, seconds)

    with Robot("script", node=stage.bus.node("script"), wait=hang) as robot:
        here = robot.pose()
        with pytest.raises(Refused):
            robot.go_to(here.x + 3.0, here.y)
    assert speeds[0] < 0.01
    assert re.fullmatch(r".* \(script\) drove until \d\d:\d\d and is out of reach; d: take over", lines[0])


def test_program_that_follows_a_lost_one_waits_for_the_lease(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    late: dict[str, int] = {}
    stage = FirstDrive(delay=lambda topic: late.get(topic, 0))
    turns: list[float] = []

    def hang(condition: Callable[[], bool], seconds: float) -> bool:
        stage.bus.run_until(lambda: condition() or speed(stage) > 0.3, seconds)
        if speed(stage) > 0.3 and not turns:
            stage.bus.run(3.5)
            late["/cmd_vel_mux/lease"] = 500_000_000  # ns: the next program hears of the mux before it has its lease
            before = stage.truth.pose.yaw
            with connect(stage, "next") as following:
                following.drive(0.0, 0.5, 1.0)
            turns.append(stage.truth.pose.yaw - before)
        return stage.bus.run_until(condition, seconds)

    with Robot("script", node=stage.bus.node("script"), wait=hang) as robot, pytest.raises((Lost, TakenOver)):
        robot.drive(0.0, 0.5, 30.0)
    assert turns[0] == pytest.approx(0.5, abs=0.2)


def test_goal_before_that_arrives_late_is_no_take_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    late: dict[str, int] = {}
    stage = FirstDrive(delay=lambda topic: late.get(topic, 0))
    with connect(stage, "first") as robot:
        here = robot.go_to(0.4, 0.0)
    late["/move_base/current_goal"] = 300_000_000  # ns: after the next goal was sent
    with connect(stage, "second") as robot:
        there = robot.go_to(here.x + 0.4, here.y)
    assert there.x - here.x == pytest.approx(0.4, abs=0.2)


def test_goal_of_a_robot_that_falls_silent_is_lost(stage: FirstDrive, robot: Robot) -> None:
    here = robot.pose()
    for name in ("/move_base", "/cmd_vel_mux"):
        end = partial(stage.bus.nodes[name].end, "the robot is switched off")
        stage.bus.at(stage.bus.now + 1_000_000_000, end)
    with pytest.raises(Lost, match="no word from the robot for"):
        robot.go_to(here.x + 0.8, here.y)


def test_goal_waits_for_the_lease_of_a_mux_that_is_found_late(stage: FirstDrive) -> None:
    stage.bus.nodes["/cmd_vel_mux"].end("it is not found yet")
    with connect(stage) as robot:
        stage.bus.at(stage.bus.now + 2_000_000_000, lambda: stage.start("/cmd_vel_mux"))
        screen = LeaseClient(stage.bus.node("screen"), "cmd_vel_mux", identity=Identity("s", "desk", "", "watch"))
        drivers: list[str] = []
        stage.client.every(0.1, lambda: drivers.append(screen.view().program))
        here = robot.pose()
        robot.go_to(here.x + 0.4, here.y)
    assert "script" in drivers


def test_limits_of_the_base_hold_for_programs(stage: FirstDrive, robot: Robot) -> None:
    robot.drive(0.0, 50.0, 0.5)
    _, turn = axes_of(stage.base.limits)
    assert 0.0 < max(abs(each.turn) for each in stage.commands) <= turn.speed + 1e-6


def test_lease_goes_back_and_the_goal_ends_with_an_exception_that_screens_name(stage: FirstDrive) -> None:
    robot, screen = connect(stage), other_client(stage)

    def drive() -> None:
        with robot:
            here = robot.pose()
            stage.bus.at(stage.bus.now + 2_000_000_000, interrupt)
            robot.go_to(here.x + 0.8, here.y)

    with pytest.raises(KeyboardInterrupt):
        drive()
    stage.bus.run(1.0)
    assert speed(stage) < 0.01
    view = robot._navigator.snapshot()
    assert view.lease.state == "free"
    assert view.goal.over
    assert describe_driver(screen.view()) == "script ended with KeyboardInterrupt"


def test_call_is_interrupted_and_the_robot_stops(stage: FirstDrive, robot: Robot) -> None:
    stage.bus.at(stage.bus.now + 2_000_000_000, robot.interrupt)
    with pytest.raises(Interrupted):
        robot.drive(0.0, 0.5, 30.0)
    stage.bus.run(0.3)
    assert speed(stage) < 0.02


def test_nearest_is_found_in_a_direction(robot: Robot) -> None:
    sides = [robot.nearest(90.0, direction) for direction in (0.0, 90.0, 180.0, -90.0)]
    assert min(sides) == robot.nearest()
    assert len(set(sides)) > 1


def test_program_is_refused_while_another_client_drives(stage: FirstDrive, robot: Robot) -> None:
    other = other_client(stage)
    stage.bus.run(0.5)
    other.take_over()
    stage.bus.run(0.5)
    with pytest.raises(Refused, match=r"laptop2 \(web\) drives the robot"):
        robot.drive(0.1, 0.0, 1.0)
    assert any("laptop2" in line for line in robot.events())


def test_program_that_drives_is_told_of_a_take_over(stage: FirstDrive, robot: Robot) -> None:
    other = other_client(stage)
    stage.bus.run(0.5)
    stage.bus.at(stage.bus.now + 1_000_000_000, other.take_over)
    with pytest.raises(TakenOver, match="laptop2"):
        robot.drive(0.0, 0.3, 10.0)
    stage.bus.run(0.6)
    assert speed(stage) < 0.01


def test_emergency_stop_refuses_the_program(stage: FirstDrive, robot: Robot) -> None:
    assert stage.ask("cmd_vel_mux/stop", Trigger()).success
    stage.bus.run(0.5)
    with pytest.raises(Refused, match="emergency stop"):
        robot.drive(0.1, 0.0, 1.0)
    assert any("EMERGENCY STOP" in line for line in robot.events())


def test_goal_that_cannot_be_reached_is_refused_with_the_reason(robot: Robot) -> None:
    with pytest.raises(Refused, match=r"\w"):
        robot.go_to(1000.0, 1000.0)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_numbers_that_are_none_are_errors_of_the_program(robot: Robot, value: float) -> None:
    with pytest.raises(ValueError, match="expected a finite number"):
        robot.go_to(value, 0.0)
    with pytest.raises(ValueError, match="expected a finite number"):
        robot.drive(value, 0.0, 1.0)


def test_robot_that_is_not_there_is_lost() -> None:
    bus = Bus()
    with Robot("script", node=bus.node("script"), wait=bus.run_until) as robot:
        with pytest.raises(Lost, match="is it localised"):
            robot.pose()
        with pytest.raises(Lost, match="still waiting for the map"):
            robot.go_to(1.0, 1.0)
        with pytest.raises(Lost, match="is the robot running"):
            robot.drive(0.1, 0.0, 1.0)
        with pytest.raises(Refused, match="nothing explores"):
            robot.explore()
