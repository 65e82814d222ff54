import math

import pytest

from ur.robot.base import load_base
from ur.robot.base.calibration import Calibration, parse_calibration
from ur.source.diagnostic import UserError
from ur.source.project import launch_library

TURNED = Calibration(0.05, 1.02, 0.96)


def test_calibration_is_read_as_it_was_written() -> None:
    assert parse_calibration(TURNED.write(), "here") == TURNED
    assert parse_calibration("", "here") == Calibration()
    assert parse_calibration("{lidar_yaw: -0.1}", "here") == Calibration(lidar_yaw=-0.1)


@pytest.mark.parametrize("text", ["{lidar_yaw: 4}", "{wheel_radius: 0}", "{wheel_radius: 3}", "{yaw: 0.1}", "0.1"])
def test_calibration_that_no_robot_has_is_refused(text: str) -> None:
    with pytest.raises(UserError, match="here"):
        parse_calibration(text, "here")


def test_calibrated_base_has_other_wheels_and_a_lidar_that_is_turned() -> None:
    base = load_base(launch_library(), "stage")
    calibrated = TURNED.apply(base)
    assert base.lidar
    assert calibrated.lidar
    assert calibrated.lidar.askew == 0.05
    assert calibrated.lidar.pose == base.lidar.pose
    assert calibrated.wheels.radius == pytest.approx(1.02 * base.wheels.radius)
    assert calibrated.wheels.separation == pytest.approx(0.96 * base.wheels.separation)
    assert TURNED.apply(load_base(launch_library(), "magni")).lidar is None


def test_second_calibration_is_added_to_the_first_one() -> None:
    both = TURNED.then(Calibration(-0.02, 0.99, 1.01))
    assert both.lidar_yaw == pytest.approx(0.03)
    assert (both.wheel_radius, both.wheel_separation) == pytest.approx((1.02 * 0.99, 0.96 * 1.01))
    assert Calibration(3.0).then(Calibration(1.0)).lidar_yaw == pytest.approx(4.0 - math.tau)
