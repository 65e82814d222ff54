"""What stops a robot unseen: the detector alone, the node on a bus, and robots in the simulator."""

import math
from pathlib import Path

import numpy as np
import pytest
from bench.navigation_parts.unseen import run_trial
from tests.ur_nodes.first_drive.drive import FirstDrive
from tests.ur_nodes.navigation.robot_stage import RobotStage
from tests.ur_nodes.navigation.synthetic import LASER, make_room, scan_points

from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.navigation.contacts import ContactSense, StallDetector
from ur_nodes.navigation.steering.speed_profile import AT_REST, DriveVelocity
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Silent

ROOM = make_room()
AHEAD, TURN = DriveVelocity(0.3, 0.0), DriveVelocity(0.0, 0.5)


def drive(
    wanted: DriveVelocity, *, wheels: float, truth: float, gyro: float | None = None, seconds: float = 4.0
) -> str:
    """Drive at 10 Hz where shares of the command reach the wheels, the robot and its gyroscope; the first stall."""
    detector, rng = StallDetector(), np.random.default_rng(3)
    odometry = real = Pose2(0.0, -1.0, 0.2)
    for step in range(round(10 * seconds)):
        if stalled := detector.step(0.1 * step, wanted, odometry):
            return stalled
        move = [Pose2(0.1 * share * wanted.speed, 0.0, 0.1 * share * wanted.turn) for share in (wheels, truth)]
        odometry, real = odometry.compose(move[0]), real.compose(move[1])
        detector.witness.update(odometry, scan_points(ROOM, real, rng), LASER[:2])
        if gyro is not None:
            detector.add_turn(0.1 * gyro * wanted.turn)
    return ""


@pytest.mark.parametrize("wanted", [AHEAD, TURN, DriveVelocity(-0.2, 0.0), DriveVelocity(0.3, 0.4)])
def test_robot_that_moves_is_not_stalled(wanted: DriveVelocity) -> None:
    assert drive(wanted, wheels=1.0, truth=1.0, gyro=1.0) == ""
    assert drive(wanted, wheels=1.0, truth=1.0, gyro=0.0) == "", "a gyroscope that is broken"


def test_wheels_that_slip_are_a_stall() -> None:
    assert drive(AHEAD, wheels=1.0, truth=0.0) == "its wheels turn and it does not move"
    assert drive(AHEAD, wheels=1.0, truth=0.0, seconds=0.5) == ""


def test_wheels_that_turn_against_the_gyroscope_are_a_stall() -> None:
    detector = StallDetector()
    yaws = np.arange(0.0, 1.0, 0.05).tolist()
    for gyro, expected in ((0.001, {"", "its wheels turn and it does not"}), (0.05, {""})):
        detector.restart()
        found = set()
        for step, yaw in enumerate(yaws):
            found.add(detector.step(0.1 * step, TURN, Pose2(0.0, 0.0, yaw)))
            detector.add_turn(gyro)
        assert found == expected


def test_wheels_that_stand_under_a_command_are_a_stall_and_at_rest_they_are_not() -> None:
    assert drive(AHEAD, wheels=0.0, truth=0.0) == "its wheels stand still under a command"
    assert drive(AHEAD, wheels=0.0, truth=0.0, seconds=2.0) == ""
    assert drive(DriveVelocity(0.02, 0.0), wheels=0.0, truth=0.0) == ""
    assert drive(AT_REST, wheels=0.0, truth=0.0) == ""


def test_pressed_bumper_is_backed_off_from_and_marked() -> None:
    robot = RobotStage()
    bumper = robot.client.publish("bumper/front", bool, Quality.LATCHED)
    goal = robot.send(3.0, 0.0)
    robot.bus.run(2.3)
    touched = robot.pose
    bumper.send(True)
    robot.bus.run(0.5)
    bumper.send(False)
    robot.bus.run(2.0)
    assert robot.pose.x < touched.x - 0.1
    assert robot.end(goal, 60.0)[0] == "succeeded"


def test_third_press_ends_a_goal_that_was_held_in_between() -> None:
    robot = RobotStage()
    bumper = robot.client.publish("bumper/front", bool, Quality.LATCHED)
    lost = robot.client.publish("amcl/lost", str, Quality.LATCHED)
    goal = robot.send(3.0, 0.0)
    for hold in ("", "lost: where is it?", ""):
        assert robot.starts_moving()
        for pressed in (True, False):
            bumper.send(pressed)
            robot.bus.run(0.3)
        assert robot.ask("move_base/clear_costmaps", Silent()).success
        for text in (hold, ""):
            lost.send(text)
            robot.bus.run(0.5)
    state, text = robot.end(goal)
    assert (state, text[-12:]) == ("aborted", "the 3rd time")


def test_mark_beside_the_robot_is_where_it_touches_something() -> None:
    bus = Bus()
    square = np.array(((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)))
    sense = ContactSense(bus.node("move_base"), "base_footprint", square, (), "", "mux")
    points = sense.beside(np.array(((0.1, 0.3), (0.9, 0.0))), 0.3)
    assert points is not None
    assert points[:, 1].min() > 0.2, "only to the left"
    assert (points[:, 0].min(), points[:, 0].max()) == pytest.approx((-0.5, 0.5), abs=0.05)
    assert sense.beside(np.array(((0.9, 0.0),)), 0.3) is None
    assert sense.beside(np.empty((0, 2)), 0.3) is None


def test_bumper_that_stays_pressed_ends_the_goal_with_that_reason() -> None:
    robot = RobotStage()
    goal = robot.send(3.0, 0.0)
    robot.bus.run(2.5)
    robot.client.publish("bumper/front", bool, Quality.LATCHED).send(True)
    assert robot.end(goal, 40.0) == ("aborted", "/bumper/front stays pressed")


def test_bumper_of_a_robot_that_stands_is_no_contact() -> None:
    robot = RobotStage()
    bumper = robot.client.publish("bumper/front", bool, Quality.LATCHED)
    for pressed in (True, False):
        bumper.send(pressed)
        robot.bus.run(0.5)
    assert robot.end(robot.send(1.0, 0.0)) == ("succeeded", "goal reached")


@pytest.mark.parametrize("number", [8, 17, 14])
def test_robot_passes_or_gives_up_before_what_no_lidar_sees(tmp_path: Path, number: int) -> None:
    trial = run_trial(number, tmp_path)
    assert trial.good, trial


def test_robot_that_is_driven_against_something_for_long_is_not_lost() -> None:
    drive = FirstDrive(seed=4)
    lost, before = drive.record("amcl/lost", str), drive.truth.pose
    drive.drive(0.4, 0.0, 25.0, "key_vel")
    slipped = drive.bus.now  # the maze's wall has stopped it, and its wheels have turned on
    drive.bus.run(1.0)
    assert slipped
    assert not any(lost)
    estimate = drive.estimates[-1].pose
    assert math.dist(drive.truth.pose[:2], before[:2]) < 8.0
    assert math.dist(drive.truth.pose[:2], estimate[:2]) < 0.3
