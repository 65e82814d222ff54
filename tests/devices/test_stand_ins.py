"""Devices without hardware, and what `ur devices --probe` and the doctor make of them and of their faults."""

from pathlib import Path

import pytest
from tests.devices.stand_ins.firmwares import (
    BOTH_SPEED_SET,
    MagniMotors,
    RplidarA1,
    Xv11Lidar,
)
from tests.devices.stand_ins.serial_stand_in import Firmware, SerialStandIn

from ur.devices.known import Device, DeviceSnapshot, Expected
from ur.devices.needs import examine
from ur.devices.probe import parse_answers, probe_script
from ur.robot.ssh.shell import LocalShell

LIMIT = 30.0  # s


def ask(path: Path, kind: str, baud: int = 115200) -> str:
    """As `ur devices --probe` asks, through the same shell."""
    return parse_answers(LocalShell().run(probe_script([(str(path), kind, baud)]), timeout=LIMIT).out)[str(path)]


def test_rplidar_is_recognised_with_old_firmware_and_behind_noise(tmp_path: Path) -> None:
    with SerialStandIn(tmp_path / "rplidar", RplidarA1((1, 17)), 115200, noise=b"\x00\xa5\xff") as device:
        assert ask(device.path, "rplidar").startswith("RPLIDAR model 1.8, firmware 1.17, number 0001")


def test_probe_neither_starts_the_lidar_nor_sends_more_than_its_question(tmp_path: Path) -> None:
    lidar = RplidarA1()
    with SerialStandIn(tmp_path / "rplidar", lidar, 115200) as device:
        ask(device.path, "rplidar")
    assert (lidar.requests, lidar.scans) == (b"\xa5\x50", False)


@pytest.mark.parametrize(
    ("firmware", "kind"), [(RplidarA1(), "rplidar"), (Xv11Lidar(), "xv11")], ids=["rplidar", "xv11"]
)
def test_device_at_another_speed_is_not_recognised_and_not_mistaken(
    tmp_path: Path, firmware: Firmware, kind: str
) -> None:
    with SerialStandIn(tmp_path / "lidar", firmware, 115200) as device:
        assert ask(device.path, kind, 57600) == ""
        assert ask(device.path, kind) != ""


def test_xv11_is_recognised_by_packets_whose_checksum_is_right(tmp_path: Path) -> None:
    with SerialStandIn(tmp_path / "new", Xv11Lidar(), 115200) as device:
        assert ask(device.path, "xv11") == "XV-11 lidar, packets arrive"
    with SerialStandIn(tmp_path / "old", Xv11Lidar(old=True), 115200) as device:
        assert ask(device.path, "xv11") == ""


def test_unplugged_device_is_reported_and_recognised_again_when_it_is_back(tmp_path: Path) -> None:
    with SerialStandIn(tmp_path / "rplidar", RplidarA1(), 115200) as device:
        device.unplug()
        assert ask(device.path, "rplidar") == "cannot be opened: No such file or directory"
        device.plug()
        assert ask(device.path, "rplidar").startswith("RPLIDAR")


def test_doctor_misses_the_unplugged_device_and_accepts_it_when_it_is_back() -> None:
    expected = Expected("lidar", "serial", "/dev/rplidar", "rplidar", 115200)
    plugged = Device("/dev/ttyUSB0", "serial", "10c4:ea60", links=("/dev/rplidar",))
    back = Device("/dev/ttyUSB1", "serial", "10c4:ea60", links=("/dev/rplidar",))
    states = [examine(DeviceSnapshot("pat", devices=found), [expected])[0].state for found in ((plugged,), (), (back,))]
    assert states == ["ready", "missing", "ready"]


def test_question_for_a_lidar_moves_no_motor(tmp_path: Path) -> None:
    motors = MagniMotors()
    with SerialStandIn(tmp_path / "motors", motors, 38400) as device:
        assert ask(device.path, "rplidar", 38400) == ""
        assert ask(device.path, "neato", 38400) == ""
    assert (motors.writes, motors.registers[BOTH_SPEED_SET]) == (0, 0)
