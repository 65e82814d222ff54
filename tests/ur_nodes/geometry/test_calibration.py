import math
from collections.abc import Iterator

import numpy as np
import pytest

from ur_nodes.geometry.calibration import CalibrationFigures, Errors, MotionCalibration
from ur_nodes.geometry.pose import Pose2

DESCRIBED = Pose2(0.1, 0.0, 0.0)
TURNED = math.radians(3.0)
NONE = Errors(0.0, 0.0, 0.0, 0.0, 0.0)


def drive(steps: int, *, turns: bool) -> Iterator[Pose2]:
    """True motions: 0.05 m and a gentle turn each, then a quarter turn on the spot."""
    for number in range(steps):
        turn = 0.05 * math.sin(number / 23.0) if turns else 0.0
        yield Pose2(0.05, 0.0, turn) if number % 100 < 80 else Pose2(0.0, 0.0, 0.08 if turns else 0.0)


def calibrate(
    mounted: Pose2,
    *,
    radius: float = 1.0,
    separation: float = 1.0,
    drift: float = 0.0,
    turns: bool = True,
    steps: int = 520,
) -> CalibrationFigures:
    """The figures of a drive of about 20 m: wheels so much larger and farther apart than described, and not alike."""
    random = np.random.default_rng(3)
    frame = DESCRIBED.compose(mounted.inverse())
    calibration, before = MotionCalibration(), Pose2(0.0, 0.0, 0.0)
    for true in drive(steps, turns=turns):
        now = Pose2(*(random.standard_normal(3) * (0.003, 0.003, 0.002)).tolist())  # of a match, not of a motion
        shown = before.inverse().compose(frame.compose(true).compose(frame.inverse())).compose(now)
        before = now
        calibration.add(Pose2(true.x / radius, 0.0, true.yaw * separation / radius + drift * true.x), shown)
    figures = calibration.figures(DESCRIBED)
    assert figures is not None
    return figures


@pytest.mark.parametrize("yaw", [TURNED, -TURNED, math.radians(8.0)])
def test_turned_lidar_is_measured_within_20_metres(yaw: float) -> None:
    figures = calibrate(Pose2(0.1, 0.0, yaw), radius=1.05, separation=0.95, drift=0.02)
    assert figures.metres == pytest.approx(21.0, abs=1.0)
    assert figures.clear.yaw == pytest.approx(yaw, abs=math.radians(0.3))
    assert math.hypot(figures.errors.x, figures.errors.y) < 0.005


@pytest.mark.parametrize(("radius", "separation"), [(1.05, 1.0), (0.95, 1.0), (1.0, 1.05), (1.0, 0.95), (1.04, 0.96)])
def test_wrong_wheels_are_measured_within_20_metres(radius: float, separation: float) -> None:
    figures = calibrate(DESCRIBED, radius=radius, separation=separation)
    assert figures.errors.radius == pytest.approx(radius - 1.0, abs=0.005)
    assert figures.errors.separation == pytest.approx(separation - 1.0, abs=0.005)
    assert (figures.clear.radius != 0.0, figures.clear.separation != 0.0) == (radius != 1.0, separation != 1.0)
    assert figures.clear[:3] == NONE[:3]


@pytest.mark.parametrize("mounted", [Pose2(0.13, 0.0, 0.0), Pose2(0.1, 0.03, 0.0), Pose2(0.07, 0.0, TURNED)])
def test_lidar_that_is_mounted_elsewhere_is_measured_in_its_described_frame(mounted: Pose2) -> None:
    errors = calibrate(mounted, steps=1500).clear
    found = DESCRIBED.compose(Pose2(errors.x, errors.y, errors.yaw))
    assert math.dist(found[:2], mounted[:2]) < 0.008
    assert found.yaw == pytest.approx(mounted.yaw, abs=math.radians(0.3))


def test_robot_as_described_has_no_clear_error_whatever_the_drift() -> None:
    assert calibrate(DESCRIBED, drift=math.radians(3.0)).clear == NONE


def test_straight_drive_shows_how_a_lidar_is_turned_and_neither_its_place_nor_the_separation() -> None:
    assert calibrate(Pose2(0.13, 0.03, 0.0), separation=1.05, turns=False).clear == NONE
    assert calibrate(Pose2(0.1, 0.0, TURNED), turns=False).clear.yaw == pytest.approx(TURNED, abs=math.radians(0.3))


def test_wheels_that_slip_teach_nothing() -> None:
    calibration = MotionCalibration()
    for _ in range(1000):
        calibration.add(Pose2(0.05, 0.0, 0.0), Pose2(0.0, 0.0, 0.0))
    assert calibration.figures(DESCRIBED) is None


def test_short_drive_shows_nothing_yet() -> None:
    calibration = MotionCalibration()
    for true in drive(100, turns=True):
        calibration.add(true, true)
    assert calibration.figures(DESCRIBED) is None
