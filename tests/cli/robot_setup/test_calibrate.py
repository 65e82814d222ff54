"""`ur robot calibrate`: what it reads, and what it writes into the robot file."""

import getpass
from pathlib import Path

import pytest

from ur.cli.robot_setup.calibrate import read_figures, write_file
from ur.devices.driver_health import DriverHealth, MotionRecord
from ur.robot.base.calibration import Calibration, write_calibration
from ur.robot.robot_file import load_robot_file, parse_robot_file
from ur.robot.ssh.shell import LocalShell
from ur.source.diagnostic import UserError
from ur.source.foreign.json_values import PrintableValue, write_json

TURNED = MotionRecord(21.0, 0.05, 0.0, 0.0, -0.04, 0.0)
DRIVER = DriverHealth("/dev/create", "Create 2", open=True, calibration=Calibration(0.01, 1.1).write())
FILE = 'name: "bob"\nbase: "magni"\ndevices: {}\n'


def observe(*records: PrintableValue) -> str:
    return "".join(f"3 {write_json(each)}\n" for each in records)


def test_figures_are_printed_and_added_to_the_calibration_that_the_drivers_use(
    capsys: pytest.CaptureFixture[str],
) -> None:
    used, found = read_figures(observe(DRIVER, TURNED), "bob")
    assert "the lidar is turned by 2.9 degrees to the left; the wheels are 4.0 % smaller" in capsys.readouterr().out
    assert used == Calibration(0.01, 1.1)
    assert found == Calibration(0.05, 0.96)
    assert read_figures(observe(TURNED), "bob")[0] is None


@pytest.mark.parametrize(
    ("records", "expected"),
    [
        ((DRIVER,), "nothing is known of its lidar and wheels yet"),
        ((DRIVER, MotionRecord(30.0, 0.0, 0.0, 0.0, 0.0, 0.0)), "after 30 m, lidar and wheels are as described"),
        ((DRIVER, MotionRecord(30.0, 0.0, 0.03, 0.0, 0.0, 0.0)), "the lidar is \\+0.030 m ahead"),
    ],
)
def test_nothing_is_written_without_an_error_that_a_robot_file_can_have(
    records: tuple[PrintableValue, ...], expected: str
) -> None:
    with pytest.raises(UserError, match=expected):
        read_figures(observe(*records), "bob")


def test_robot_file_is_changed_when_the_user_agrees(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    path, user = tmp_path / "robot.yaml", getpass.getuser()
    with pytest.raises(UserError, match="there is no"):
        write_file(LocalShell(), user, Calibration(0.05), lambda: True, "~/robot.yaml")
    path.write_text(FILE)
    assert not write_file(LocalShell(), user, Calibration(0.05), lambda: False, "~/robot.yaml")
    assert path.read_text() == FILE
    assert write_file(LocalShell(), user, Calibration(0.05), lambda: True, "~/robot.yaml")
    assert path.read_text().startswith(FILE)
    robot = load_robot_file(path)
    assert robot
    assert robot.calibration == Calibration(0.05)


@pytest.mark.parametrize(
    "old", ["", "calibration: {lidar_yaw: 1}\n", "calibration:\n  lidar_yaw: 1\n  wheel_radius: 1.1\n"]
)
def test_new_calibration_replaces_the_old_one_and_the_rest_stays(old: str) -> None:
    text = write_calibration(f"name: bob\n{old}base: magni\n", Calibration(0.05))
    robot = parse_robot_file(text)
    assert robot
    assert robot.calibration == Calibration(0.05)
    assert text.startswith("name: bob\nbase: magni\ncalibration: ")
