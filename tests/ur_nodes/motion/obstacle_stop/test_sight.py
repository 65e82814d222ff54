"""Points that scans and ranges leave behind, and for how long."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.ur_nodes.motion.obstacle_stop.conftest import load, scan_of, seeing

from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.obstacle_stop.obstacle_stop import contact_points, make_sight
from ur_nodes.motion.obstacle_stop.sight import MEMORY, Contact, Odometer, SensorRanges, Sight, move, touch


def echo(distance: float, at: float) -> SensorRanges:
    return SensorRanges(np.array([distance]), (0.05, 4.0), at, cone=0.436)


def test_wall_ahead_lies_where_the_lidar_measured_it(sight: Sight) -> None:
    points = seeing(sight, scan_of(0.6, 1.0)).points_at(1.0)
    assert points[:, 0] == pytest.approx(0.7, abs=1e-6)  # the lidar is 0.1 m before the axle


def test_points_stay_where_they_are_while_the_base_drives(sight: Sight) -> None:
    seen = seeing(move(sight, Odometer(Pose2(0.0, 0.0, 0.0), 0.5, 0.0, 1.0)), scan_of(0.6, 1.0))
    later = move(seen, Odometer(Pose2(0.1, 0.0, 0.0), 0.5, 0.0, 1.2))
    assert later.points_at(1.2)[:, 0] == pytest.approx(0.6, abs=1e-6)
    assert later.points_at(1.3)[:, 0] == pytest.approx(0.55, abs=1e-6)


def test_beams_of_a_turning_lidar_count_from_their_own_time(sight: Sight) -> None:
    driving = move(sight, Odometer(Pose2(0.0, 0.0, 0.0), 0.5, 0.0, 1.0))
    driving = move(driving, Odometer(Pose2(0.05, 0.0, 0.0), 0.5, 0.0, 1.1))
    slow = replace(scan_of(0.6, 1.0), turn=0.1)
    points = seeing(driving, slow).points_at(1.0)
    front = points[np.argmin(np.abs(points[:, 1]))]
    assert front[0] == pytest.approx(0.725, abs=2e-3)  # measured half a turn, 0.05 s, later


@pytest.mark.parametrize("turn", [0.2, -0.2])  # s from the first beam to the last, of either direction
def test_wall_beside_a_base_that_turns_is_where_each_beam_measured_it(sight: Sight, turn: float) -> None:
    at, speed = 1.0 - min(0.0, turn), 1.5  # s, rad/s
    turning = sight
    for time in (1.0, 1.1, 1.2):
        turning = move(turning, Odometer(Pose2(0.0, 0.0, speed * (time - 1.0)), 0.0, speed, time))
    angles = -math.pi + np.arange(360) * math.pi / 180.0
    heading = speed * (at + turn * np.arange(360) / 359.0 - 1.0)
    mount = sight.sensors[0].mount.offset[0] * np.cos(heading)
    across = np.cos(angles + heading)
    ranges = np.where(across > 0.5, (0.6 - mount) / np.maximum(across, 0.5), math.inf)
    points = seeing(turning, SensorRanges(ranges, (0.12, 12.0), at, -math.pi, math.pi / 180.0, turn)).points_at(1.0)
    assert len(points) > 60
    assert points[:, 0] == pytest.approx(0.6, abs=0.005)


@pytest.mark.parametrize("turn", [0.2, -0.2])
def test_point_that_a_turning_base_leaves_unmeasured_is_remembered(sight: Sight, turn: float) -> None:
    """The lidar turns against the base: the arc between its last beam and its first is seen by the next scan only."""
    seen = seeing(move(sight, Odometer(Pose2(0.0, 0.0, 0.0), 0.0, 0.0, 1.0)), scan_of(0.5, 1.0, toward=math.pi))
    speed = -1.5 * math.copysign(1.0, turn)
    for time in (1.1, 1.2):
        seen = move(seen, Odometer(Pose2(0.0, 0.0, speed * (time - 1.0)), 0.0, speed, time))
    nothing = SensorRanges(np.full(360, math.inf), (0.12, 12.0), 1.0 - min(0.0, turn), -math.pi, math.pi / 180.0, turn)
    left = seeing(seen, nothing).points_at(1.2)
    bearing = np.arctan2(left[:, 1], left[:, 0] - sight.sensors[0].mount.offset[0])
    assert len(left) > 10
    assert (np.abs(bearing) > math.pi - 0.45).all()


@pytest.mark.parametrize("value", [math.nan, 0.0, 0.05, math.inf, 12.0, 20.0])
def test_beams_that_met_nothing_or_measured_nothing_leave_no_point(sight: Sight, value: float) -> None:
    reading = SensorRanges(np.array([0.5, value, math.inf]), (0.12, 12.0), 1.0, 0.0, 0.1)
    assert len(seeing(sight, reading).points_at(1.0)) == 1


def test_beam_that_met_something_too_near_to_measure_counts_at_the_least_range(sight: Sight) -> None:
    reading = SensorRanges(np.array([-math.inf, math.inf]), (0.12, 12.0), 1.0, 0.0, 0.1)
    assert seeing(sight, reading).points_at(1.0) == pytest.approx(np.array([[0.22, 0.0]]))


def test_scan_without_a_measurement_is_no_scan(sight: Sight) -> None:
    covered = seeing(sight, SensorRanges(np.full(360, math.nan), (0.12, 12.0), 1.0, -math.pi, 0.0175))
    assert covered.age(sight.sensors[0], 1.0) == math.inf
    free = seeing(sight, SensorRanges(np.full(360, math.inf), (0.12, 12.0), 1.0, -math.pi, 0.0175))
    assert free.age(sight.sensors[0], 1.2) == pytest.approx(0.2)


def test_parts_of_the_robot_itself_are_left_out(sight: Sight) -> None:
    inside = SensorRanges(np.array([0.15, math.inf]), (0.12, 12.0), 1.0, math.pi, 0.1)  # 5 cm behind the axle
    assert len(seeing(sight, inside).points_at(1.0)) == 0


def test_scan_that_is_older_than_the_newest_is_ignored(sight: Sight) -> None:
    newer = seeing(sight, scan_of(0.6, 2.0))
    assert seeing(newer, scan_of(0.3, 1.0)) is newer


def test_points_age_out_when_no_scan_follows(sight: Sight) -> None:
    seen = seeing(sight, scan_of(0.6, 1.0))
    assert len(seen.points_at(1.0 + MEMORY - 0.1)) > 0
    assert len(seen.points_at(1.0 + MEMORY + 0.1)) == 0


def test_echo_is_remembered_once_it_is_out_of_the_cone_and_forgotten_when_the_cone_is_free() -> None:
    magni = make_sight(load("magni"))
    ahead = next(n for n, sensor in enumerate(magni.sensors) if sensor.name == "sonar_3")
    still = move(magni, Odometer(Pose2(0.0, 0.0, 0.0), 0.0, 0.0, 1.0))
    heard = seeing(still, echo(0.5, 1.0), ahead)
    count = len(heard.points_at(1.0))
    assert count > 3
    assert len(seeing(heard, echo(math.inf, 1.2), ahead).points_at(1.2)) == 0
    turned = move(heard, Odometer(Pose2(0.0, 0.0, 0.45), 0.0, 0.0, 1.4))
    turned = move(turned, Odometer(Pose2(0.0, 0.0, 0.9), 0.0, 0.0, 1.8))
    gone = seeing(turned, echo(math.inf, 1.8), ahead)
    assert len(gone.points_at(1.8)) == count
    assert len(gone.points_at(1.0 + MEMORY + 0.1)) == 0


def test_upside_down_sonar_looks_where_its_file_says() -> None:
    loki = make_sight(load("loki"))
    left = next(n for n, sensor in enumerate(loki.sensors) if sensor.name == "sonar_8")
    points = seeing(loki, SensorRanges(np.array([0.3]), (0.02, 4.0), 1.0, cone=0.436), left).points_at(1.0)
    assert points[:, 1].min() > 0.3
    assert loki.sensors[left].sees(np.array([(-0.126, 0.5), (-0.126, -0.5)])).tolist() == [True, False]


def test_odometry_that_begins_anew_forgets_all_points(sight: Sight) -> None:
    seen = seeing(move(sight, Odometer(Pose2(0.0, 0.0, 0.0), 0.0, 0.0, 1.0)), scan_of(0.6, 1.0))
    assert len(move(seen, Odometer(Pose2(9.0, 0.0, 0.0), 0.0, 0.0, 1.1)).points_at(1.1)) == 0


def test_bumper_touches_its_part_of_the_outline_until_it_is_released() -> None:
    base = load("stage")
    sight = make_sight(base)
    front: tuple[Contact, str] = ("bumper", "front")
    pressed = touch(sight, front, contact_points(base, sight.hull, front))
    assert pressed.touched[front][:, 0].min() > 0.1
    assert touch(pressed, ("cliff", "front"), None).touched == pressed.touched
    assert touch(pressed, front, None).touched == {}
