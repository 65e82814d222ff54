import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
import pytest
from tests.ur_nodes.slam.drives import SOFA, WALLS, drive
from tests.ur_nodes.slam.rooms import scan_at

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.gyro import Gyro, Headings
from ur_nodes.slam.tracker import MapTracker

ROOMS = np.vstack((WALLS, SOFA))
PERIOD = 0.2  # s between scans
PATH = [*drive(-2.0, 6.5, 0.1), *drive(6.5, -2.0, 0.1), *drive(-2.0, 6.5, 0.1)]
BIAS = 0.02  # rad/s


def fill(gyro: Gyro, rate: Callable[[float], float], seconds: float, begin: float = 0.0) -> None:
    for count in range(round(seconds * 100) + 1):
        gyro.add(begin + count / 100, rate(begin + count / 100))


def turning_wheels(path: Sequence[Pose2], error: float, slip: float = 0.0) -> list[Pose2]:
    """Odometry that turns by `error` rad a metre and by chance by `slip` rad a step, after a second at rest."""
    odometry, random = [path[0]] * 6, np.random.default_rng(1)
    for before, after in pairwise(path):
        step = before.inverse().compose(after)
        odometry.append(
            odometry[-1].compose(
                Pose2(step.x, step.y, step.yaw + error * math.hypot(step.x, step.y) + slip * random.standard_normal())
            )
        )
    return odometry


def map_rooms(
    error: float, sign: float | None, slip: float = 0.0, view: float = math.pi
) -> tuple[Headings, MapTracker, float]:
    """Map with wheels that turn wrongly by `error` rad/m: the headings, the map, the worst error in m.

    `sign` -1: the gyroscope hangs upside down; None: there is none.
    """
    truth = [PATH[0]] * 5 + PATH
    headings, tracker, worst = Headings(), MapTracker(), 0.0
    for number, (pose, wheels) in enumerate(zip(truth, turning_wheels(PATH, error, slip), strict=True)):
        now = number * PERIOD
        step = truth[number - 1].inverse().compose(pose) if number else Pose2(0.0, 0.0, 0.0)
        for count in range(1, 21 if sign is not None else 0):
            headings.gyro.add(now - PERIOD + count * PERIOD / 20, (sign or 0.0) * step.yaw / PERIOD + BIAS)
        scan = scan_at(ROOMS, pose, 0.03, number, view, 5.0)
        estimate = tracker.add_scan(scan, wheels, headings.at(now, wheels))
        if not estimate.still:
            headings.judge(estimate.step, estimate.wheels)
        true = truth[0].inverse().compose(pose)
        worst = max(worst, math.hypot(estimate.pose.x - true.x, estimate.pose.y - true.y))
    return headings, tracker, worst


def test_turn_is_the_sum_of_the_rates_without_their_bias() -> None:
    gyro = Gyro()
    fill(gyro, lambda _: BIAS, 10.0)
    for second in range(9):
        gyro.rest(float(second), second + 1.0)
    assert gyro.bias == pytest.approx(BIAS)
    fill(gyro, lambda _: 0.5 + BIAS, 3.0, 10.01)
    turn = gyro.turn(10.5, 12.25)
    assert turn == pytest.approx(0.5 * 1.75, abs=0.001)


@pytest.mark.parametrize(("begin", "end"), [(-1.0, 1.0), (1.5, 2.5), (4.0, 4.5), (3.0, 2.0)])
def test_turn_is_not_known_before_rates_across_a_gap_and_after_their_end(begin: float, end: float) -> None:
    gyro = Gyro()
    fill(gyro, lambda _: 1.0, 2.0)
    fill(gyro, lambda _: 1.0, 1.0, 2.4)
    assert gyro.turn(begin, end) is None
    assert gyro.turn(2.5, 3.0) == pytest.approx(0.5, abs=0.01)


def test_rates_of_a_robot_that_is_turned_by_hand_are_no_bias() -> None:
    gyro = Gyro()
    fill(gyro, lambda _: 0.7, 2.0)
    gyro.rest(0.0, 2.0)
    assert gyro.bias == 0.0


def test_clock_that_begins_anew_forgets_what_was_before() -> None:
    gyro = Gyro()
    fill(gyro, lambda _: 1.0, 2.0, 100.0)
    fill(gyro, lambda _: 1.0, 2.0, 0.0)
    assert gyro.turn(0.5, 1.5) == pytest.approx(1.0, abs=0.01)


def wheels_and_scans(headings: Headings, error: float, sign: float) -> list[float | None]:
    """The headings on a path, with scans that show the truth."""
    truth, out = [PATH[0]] * 5 + PATH, list[float | None]()
    for number, (pose, wheels) in enumerate(zip(truth, turning_wheels(PATH, error), strict=True)):
        now = number * PERIOD
        step = truth[number - 1].inverse().compose(pose) if number else Pose2(0.0, 0.0, 0.0)
        for count in range(1, 21):
            headings.gyro.add(now - PERIOD + count * PERIOD / 20, sign * step.yaw / PERIOD + BIAS)
        out.append(headings.at(now, wheels))
        headings.judge(step, Pose2(step.x, step.y, step.yaw + error * math.hypot(step.x, step.y)))
    return out


def test_heading_is_given_once_the_scans_show_that_the_gyroscope_turns_better() -> None:
    headings = Headings()
    found = wheels_and_scans(headings, math.radians(6.0), 1.0)
    assert found[:15] == [None] * 15
    assert headings.trusted
    assert not headings.contradicted
    assert found[-1] is not None
    assert found[-60] is not None
    true = PATH[-60].inverse().compose(PATH[-1])
    assert abs(wrap_angle(found[-1] - found[-60] - true.yaw)) < 0.02


def test_gyroscope_that_hangs_upside_down_is_not_used_and_reported() -> None:
    headings = Headings()
    assert set(wheels_and_scans(headings, 0.01, -1.0)) == {None}
    assert headings.contradicted


def test_wheels_that_turn_well_are_not_replaced() -> None:
    headings = Headings()
    assert set(wheels_and_scans(headings, 0.0, 1.0)) == {None}
    assert not headings.contradicted


def test_robot_without_a_gyroscope_has_no_heading() -> None:
    headings = Headings()
    for number, pose in enumerate(PATH[:50]):
        assert headings.at(number * PERIOD, pose) is None
        headings.judge(Pose2(0.1, 0.0, 0.0), Pose2(0.1, 0.0, 0.2))
    assert not headings.trusted
    assert not headings.contradicted


def test_gyroscope_keeps_a_robot_on_the_map_whose_wheels_slip() -> None:
    headings, _, worst = map_rooms(0.0, 1.0, 0.3)
    assert headings.trusted
    assert worst < 0.2
    assert map_rooms(0.0, None, 0.3)[2] > 2.0 * worst


@pytest.mark.parametrize(("error", "sign"), [(6.0, -1.0), (0.5, 1.0)])
def test_gyroscope_that_is_wrong_or_not_needed_changes_nothing(error: float, sign: float) -> None:
    assert map_rooms(math.radians(error), sign)[2] == map_rooms(math.radians(error), None)[2]
