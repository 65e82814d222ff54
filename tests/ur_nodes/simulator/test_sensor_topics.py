import math
from itertools import pairwise
from pathlib import Path

import pytest
from tests.ur_nodes.first_drive.stage import DrivenStage
from tests.ur_nodes.simulator.conftest import PACKAGE

from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery, Imu, Joints, Odometry, Range, Scan


def test_sonars_share_a_topic_and_have_a_frame_each() -> None:
    stage = DrivenStage(base="magni")
    sonars = stage.base.sonars
    assert sonars is not None
    ranges, transforms = stage.record(sonars.topic, Range), stage.record("/tf", tuple)
    stage.bus.run(2.0)
    assert {each.frame for each in ranges} == {sonar.frame for sonar in sonars.at}
    one = [each for each in ranges if each.frame == sonars.at[0].frame]
    assert one[2].stamp - one[1].stamp == pytest.approx(1e9 / sonars.rate, abs=5e6)
    assert (one[0].field_of_view, one[0].range_min, one[0].range_max) == (
        sonars.field_of_view,
        sonars.range_min,
        sonars.range_max,
    )
    assert not one[0].infrared
    assert 0.2 < one[0].range < 3.0  # a wall of the maze
    # Nobody has to wait for the transform of a range.
    assert {each.stamp for each in ranges} <= {each[0].stamp for each in transforms}


def test_inertial_unit_battery_and_wheels_publish_as_the_base_says() -> None:
    stage = DrivenStage(battery_charge=0.5)
    imu, battery = stage.base.imu, stage.base.battery
    assert imu is not None
    assert battery is not None
    readings, states = stage.record(imu.topic, Imu), stage.record(battery.topic, Battery)
    joints = stage.record("joint_states", Joints)
    stage.bus.run(2.5)
    assert {b.stamp - a.stamp for a, b in pairwise(readings)} == {round(1e9 / imu.rate)}
    assert readings[0].frame == imu.frame
    assert sum(each.force[2] for each in readings[:20]) / 20 == pytest.approx(9.81, abs=0.1)
    assert readings[0].turning_variance == pytest.approx(imu.gyro_noise**2)
    assert readings[0].force_variance == pytest.approx(imu.accel_noise**2)
    assert math.hypot(*readings[0].orientation) == pytest.approx(1.0)
    assert states[1].stamp - states[0].stamp == 1_000_000_000
    assert states[0].fraction == pytest.approx(0.5, abs=0.01)
    assert states[0].voltage == pytest.approx((battery.voltage_full + battery.voltage_empty) / 2, abs=0.05)
    assert states[0].current == pytest.approx(-battery.current_idle, abs=0.05)
    assert len(joints[0].speeds) == 2


def test_bumpers_tell_newcomers_and_change_when_the_robot_runs_into_something() -> None:
    stage = DrivenStage()
    front, back = (stage.record(f"bumper/{side}", bool, Quality.LATCHED_EVERY) for side in ("front", "back"))
    stage.bus.run(0.1)
    assert (front, back) == ([False], [False])
    assert stage.place(0.5, 0.0, name="obstacle_1").success
    assert stage.drive_until(lambda: len(front) == 2, 0.4, 0.0, 10.0)
    assert stage.drive_until(lambda: len(front) == 3, -0.2, 0.0, 10.0)
    assert front == [False, True, False]
    assert back == [False]


def test_cliff_sensors_report_a_drop_while_the_robot_is_before_it(tmp_path: Path) -> None:
    maze = PACKAGE / "n_map_server" / "maps" / "maze.yaml"
    world = tmp_path / "stair.yaml"
    world.write_text(f"floor_plan: {maze}\ndrops:\n  - {{pose: [0.7, 0.5, 0.0], size: [0.4, 1.0]}}\n", "utf-8")
    stage = DrivenStage(world, base="botvac")
    left, right = (stage.record(f"cliff/{side}", bool, Quality.LATCHED_EVERY) for side in ("left", "right"))
    stage.bus.run(0.1)
    assert (left, right) == ([False], [False])
    assert stage.drive_until(lambda: len(left) == 2, 0.2, 0.0, 20.0)
    assert stage.drive_until(lambda: len(left) == 3, -0.2, 0.0, 20.0)
    assert left == [False, True, False]


def test_simulated_robot_with_errors_reports_them_and_a_calibrated_one_does_not() -> None:
    wrong = "{lidar_yaw: 0.1, wheel_radius: 1.1}"
    for calibration, factor, angle in (("", 1.0 / 1.1, 0.0), (wrong, 1.0, 0.1)):
        stage = DrivenStage(errors=wrong, calibration=calibration)
        odometry, scans = stage.record("odom", Odometry), stage.record("scan", Scan)
        stage.drive(0.3, 0.0, 3.0)
        driven = stage.truth.pose.x - stage.truths[0].pose.x
        assert odometry[-1].pose.x / driven == pytest.approx(factor, abs=0.02)
        assert stage.base.lidar
        assert scans[-1].angle_min == pytest.approx(stage.base.lidar.angle_min + angle)
