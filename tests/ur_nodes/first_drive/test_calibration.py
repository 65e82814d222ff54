import math
from pathlib import Path

import pytest
from tests.ur_nodes.first_drive.drive import FirstDrive

from ur.devices.driver_health import MotionRecord, describe_errors, parse_records
from ur.robot.base.calibration import parse_calibration
from ur_nodes.geometry.pose import wrap_angle

WRONG = "{lidar_yaw: 0.0524, wheel_separation: 1.05}"


def go(drive: FirstDrive, x: float, y: float, degrees: float) -> float:
    """Drive to a goal; the error (degrees) of the robot's heading there."""
    assert drive.go(x, y, math.radians(degrees)).state == "succeeded"
    assert math.dist(drive.truth.pose[:2], (x, y)) < 0.1
    return abs(math.degrees(wrap_angle(drive.truth.pose.yaw - math.radians(degrees))))


def read_record(folder: Path) -> MotionRecord:
    path = folder / "ubiquity_launches/drivers/amcl.calibration.json"
    (record,) = parse_records(f"0 {path.read_text()}", MotionRecord)
    return record


def test_drive_to_two_goals_shows_what_to_calibrate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    wrong = FirstDrive(errors=WRONG, seed=1)
    assert go(wrong, 7.87, 1.53, -140.0) > 2.0
    go(wrong, 4.0, 1.53, 180.0)
    wrong.bus.run(6.0)
    found, expected = read_record(tmp_path), parse_calibration(WRONG, "errors")
    assert found.yaw == pytest.approx(expected.lidar_yaw, abs=math.radians(0.3))
    assert 1.0 + found.separation == pytest.approx(expected.wheel_separation, abs=0.01)  # where the tyres touch
    assert (found.x, found.y, found.radius) == (0.0, 0.0, 0.0)
    assert describe_errors(found).startswith("the lidar is turned by 3.0 degrees to the left; the wheels are")


def test_calibrated_robot_stops_as_it_was_told_and_needs_no_other_calibration(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    calibrated = FirstDrive(errors=WRONG, calibration=WRONG, seed=1)
    assert go(calibrated, 7.87, 1.53, -140.0) < 1.5
    go(calibrated, 5.0, 1.53, 180.0)
    calibrated.bus.run(6.0)
    assert describe_errors(read_record(tmp_path)) == ""
