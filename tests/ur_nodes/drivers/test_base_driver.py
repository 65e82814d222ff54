"""Drivers of bases behind stand-ins, with the faults that boards and lines have."""

import math
import random
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from tests.base_contract import load
from tests.ur_nodes.drivers.rig import DriverRig

from ur.robot.base import Base
from ur.robot.base.own_drivers import OWN_DRIVERS
from ur_nodes.drivers.boards.create2 import Create2Firmware
from ur_nodes.drivers.health import Report
from ur_nodes.drivers.registry import BOARDS
from ur_nodes.ports.node import SECOND
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery, Joints, Odometry, Transform

BOARD_NAMES = sorted(BOARDS)
REST = 0.02  # m/s


def with_board(name: str) -> Any:
    """Change a base: its driver is another one of ours."""
    driver = load("create2", "").driver
    assert driver

    def change(base: Base) -> Base:
        return replace(base, driver=replace(driver, protocol=name, device=OWN_DRIVERS[name].device))

    return change


def make_rig(name: str, report: Report = lambda _: None) -> DriverRig:
    return DriverRig("create2", change=with_board(name), report=report)


def drive_off(rig: DriverRig) -> None:
    assert rig.drive_until(lambda: rig.truth.twist.forward > 0.25, 0.3, 0.0, 3.0)


def rest_after(rig: DriverRig, seconds: float = 0.3) -> float:
    """The speed of the robot a time after now, without a command."""
    rig.bus.run(seconds)
    return max(abs(rig.truth.twist.forward), abs(rig.truth.twist.turn))


def lines(rig: DriverRig) -> list[str]:
    return [text for _, text in rig.bus.nodes["/base_driver"].lines]


@pytest.mark.parametrize("name", BOARD_NAMES)
def test_odometry_follows_the_robot_and_joints_and_frame_agree_with_it(name: str) -> None:
    rig = make_rig(name)
    odometry, joints = rig.record("odom", Odometry), rig.record("joint_states", Joints)
    frames = rig.record("/tf", tuple)
    rig.drive(0.0, 0.0, 0.5)
    rig.drive(0.25, 0.3, 3.0)
    rig.drive(0.0, 0.0, 1.0)
    pose, truth = odometry[-1].pose, rig.truth.pose
    assert math.hypot(pose.x - truth.x, pose.y - truth.y) < 0.03
    assert abs(pose.yaw - truth.yaw) < 0.06
    assert odometry[-1].pose_covariance[0, 0] > 1e-6
    rates = len(odometry) / 4.5
    assert 15.0 < rates <= rig.base.odometry.rate * 1.1
    mean = sum(joints[-1].angles) / 2.0 * rig.base.wheels.radius
    assert mean == pytest.approx(0.25 * 3.0, abs=0.1)
    last: Transform = [each for each in frames if each[0].child == "base_footprint"][-1][0]
    assert (last.parent, last.stamp) == ("odom", odometry[-1].stamp)


@pytest.mark.parametrize("name", BOARD_NAMES)
def test_motors_stop_when_commands_end_and_when_the_node_ends(name: str) -> None:
    rig = make_rig(name)
    drive_off(rig)
    assert rest_after(rig) < REST
    drive_off(rig)
    rig.bus.nodes["/base_driver"].end("the test ends it")
    assert rest_after(rig) < REST


def test_robot_rests_after_the_host_of_its_driver_was_killed_though_commands_go_on() -> None:
    rig = make_rig("create2")
    drive_off(rig)
    rig.orphaned = True
    rig.drive(0.3, 0.0, 0.3)
    assert abs(rig.truth.twist.forward) < REST
    assert any("the process that started this driver was killed" in line for line in lines(rig))


@pytest.mark.parametrize("name", BOARD_NAMES)
@pytest.mark.parametrize("seed", range(5))
def test_robot_rests_after_its_driver_was_killed_at_any_moment(name: str, seed: int) -> None:
    rig = make_rig(name)
    drive_off(rig)
    rig.bus.run(random.Random(seed).random() * 0.05)
    for line in rig.lines:
        line.dead = True
    assert rest_after(rig) < REST


@pytest.mark.parametrize("name", BOARD_NAMES)
def test_unplugged_board_is_named_and_drives_again_when_it_is_back(name: str) -> None:
    rig = make_rig(name)
    odometry = rig.record("odom", Odometry)
    drive_off(rig)
    rig.cable.plugged = False
    rig.drive(0.3, 0.0, 1.0)
    assert any("unplugged" in line and BOARDS[name](rig.base).name in line for line in lines(rig))
    count, place = len(odometry), odometry[-1].pose
    rig.cable.plugged = True
    rig.bus.run(0.5)
    assert rest_after(rig) < REST
    drive_off(rig)
    assert len(odometry) > count
    assert odometry[count].pose.x == pytest.approx(place.x, abs=0.05)


@pytest.mark.parametrize("name", BOARD_NAMES)
@pytest.mark.parametrize("seed", range(4))
def test_noise_and_lost_halves_of_frames_move_nothing_that_was_not_asked_for(name: str, seed: int) -> None:
    rig = make_rig(name)
    odometry = rig.record("odom", Odometry)
    rig.drive(0.0, 0.0, 0.5)
    rig.cable.random = random.Random(seed)
    rig.cable.noise, rig.cable.cut = 0.001, 0.02
    rig.drive(0.2, 0.0, 2.0)
    assert max(abs(each.twist.forward) for each in rig.truths) < 0.3 * 1.3
    rig.cable.noise = rig.cable.cut = 0.0
    assert rest_after(rig) < REST
    assert all(abs(each.twist.forward) < 2.0 for each in odometry)


@pytest.mark.parametrize("name", BOARD_NAMES)
def test_board_that_answers_late_does_not_drive_blind(name: str) -> None:
    rig = make_rig(name)
    rig.drive(0.0, 0.0, 0.5)
    rig.cable.late = 5.0
    rig.drive(0.2, 0.0, 1.5)
    assert rest_after(rig, 0.05) < REST
    assert any("no wheel counts for 0.4 s" in line for line in lines(rig))
    rig.cable.late = 0.0
    rig.drive(0.0, 0.0, 5.5)
    drive_off(rig)


@pytest.mark.parametrize("name", BOARD_NAMES)
def test_wrong_device_is_reported_with_the_device_and_what_to_do(name: str) -> None:
    rig = make_rig(name)
    rig.firmware.receive = lambda data: b"AT+OK\r\n" if data else b""
    rig.firmware.tick = lambda: b"$GPGGA,noise*00\r\n"
    rig.drive(0.2, 0.0, 2.0)
    assert rig.truth.pose.x == pytest.approx(0.0, abs=0.01)
    assert any(line.startswith("/dev/test: no answer of") and "ur devices" in line for line in lines(rig))


def test_counters_that_wrap_leave_no_jump() -> None:
    rig = make_rig("create2")
    odometry = rig.record("odom", Odometry)
    firmware = rig.firmware
    assert isinstance(firmware, Create2Firmware)
    firmware._counted = 0xFFFF - 200
    rig.drive(0.0, 0.0, 0.5)
    rig.drive(0.25, 0.0, 2.0)
    rig.drive(-0.25, 0.0, 3.0)
    steps = [abs(b.pose.x - a.pose.x) for a, b in pairwise(odometry)]
    assert max(steps) < 0.05
    assert not any("jumped" in line for line in lines(rig))


def test_counters_that_jump_are_left_out_and_stop_the_robot_while_they_do() -> None:
    rig = make_rig("arduino")
    odometry = rig.record("odom", Odometry)
    drive_off(rig)
    for _ in range(40):
        rig.firmware._counted += 100_000
        rig.drive(0.3, 0.0, 0.05)
    assert rest_after(rig, 0.01) < REST
    assert max(each.pose.x for each in odometry) < 3.0
    assert any("its wheel counters jump" in line for line in lines(rig))
    drive_off(rig)


@pytest.mark.parametrize("name", ["arduino", "magni"])
def test_emergency_stop_is_reported_and_the_robot_does_not_jump_off_after_it(name: str) -> None:
    rig = make_rig(name)
    rig.drive(0.0, 0.0, 1.5)
    drive_off(rig)
    rig.firmware.power = False
    rig.drive(0.3, 0.0, 2.0)
    assert rest_after(rig, 0.01) < REST
    assert any("does not drive: its motors have no power" in line for line in lines(rig))
    rig.firmware.power = True
    rig.bus.run(2.0)
    assert rest_after(rig) < REST
    drive_off(rig)
    assert any("drives again" in line for line in lines(rig))


def test_create_that_was_lifted_is_asked_to_drive_again() -> None:
    rig = make_rig("create2")
    drive_off(rig)
    rig.firmware.lifted = True
    rig.drive(0.3, 0.0, 1.0)
    assert rest_after(rig, 0.01) < REST
    assert any("a wheel hangs in the air" in line for line in lines(rig))
    rig.firmware.lifted = False
    rig.drive(0.0, 0.0, 1.5)
    drive_off(rig)


def test_create_is_left_as_it_was_found() -> None:
    rig = make_rig("create2")
    drive_off(rig)
    rig.bus.nodes["/base_driver"].end("the test ends it")
    rig.bus.run(0.1)
    assert rig.firmware.mode == 0


def test_battery_and_bumpers_are_published_and_a_low_battery_is_reported() -> None:
    rig = make_rig("create2")
    states, left = rig.record("battery_state", Battery), rig.record("bumper/left", bool, Quality.LATCHED)
    rig.drive(0.0, 0.0, 1.2)
    assert states[-1].voltage == pytest.approx(16.5, abs=0.01)
    assert (states[-1].capacity, states[-1].technology) == (3.0, "nimh")
    assert left == [False]
    rig.bench.plant.battery = lambda: (12.0, -0.2, 0.1, 3.0)  # type: ignore[method-assign]
    rig.drive(0.0, 0.0, 2.0)
    assert states[-1].fraction == pytest.approx(0.1 / 3.0, abs=0.001)
    assert any("the battery is empty (12.0 V)" in line for line in lines(rig))


def test_old_firmware_of_a_magni_is_refused_with_what_to_do() -> None:
    rig = make_rig("magni")
    rig.firmware._version = 20
    rig.bus.run(1.0)
    rig.cable.plugged = False
    rig.bus.run(0.1)
    rig.cable.plugged = True
    rig.drive(0.3, 0.0, 1.0)
    assert any("firmware 20, expected 35 or later" in line for line in lines(rig))
    assert rig.truth.pose.x == pytest.approx(0.0, abs=0.01)


def test_magni_board_that_sends_no_odometry_by_itself_is_asked_for_it() -> None:
    rig = make_rig("magni")
    rig.firmware._reports = False
    odometry = rig.record("odom", Odometry)
    rig.drive(0.25, 0.0, 2.0)
    assert odometry[-1].pose.x == pytest.approx(rig.truth.pose.x, abs=0.06)
    assert (odometry[-1].stamp - odometry[-3].stamp) / SECOND < 0.3
