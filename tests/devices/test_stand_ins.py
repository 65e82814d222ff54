"""Devices without hardware, and what `ur devices --probe` and the doctor make of them and of their faults."""

from __future__ import annotations

import os
import select
import termios
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.devices.stand_ins.firmwares import (
    BOTH_SPEED_SET,
    FIRMWARE_VERSION,
    READ,
    RESPONSE,
    WRITE,
    MagniMotors,
    RplidarA1,
    Xv11Lidar,
    make_magni_packet,
)
from tests.devices.stand_ins.serial_stand_in import Firmware, SerialStandIn

from ur.devices.device import Device, DeviceSnapshot, Expected
from ur.devices.needs import examine
from ur.devices.probe import parse_answers, probe_script
from ur.robot.ssh.shell import LocalShell

LIMIT = 30.0  # s


def ask(path: Path, kind: str, baud: int = 115200) -> str:
    """As `ur devices --probe` asks, through the same shell."""
    return parse_answers(LocalShell().run(probe_script([(str(path), kind, baud)]), timeout=LIMIT).out)[str(path)]


@contextmanager
def opened(path: Path, speed: int) -> Iterator[int]:
    line = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        tty.setraw(line)
        mode = termios.tcgetattr(line)
        mode[4] = mode[5] = speed
        termios.tcsetattr(line, termios.TCSANOW, mode)
        yield line
    finally:
        os.close(line)


def read(line: int, enough: Callable[[bytes], bool]) -> bytes:
    end, data = time.monotonic() + LIMIT, b""
    while not enough(data):
        assert select.select([line], [], [], max(0.0, end - time.monotonic()))[0], data
        data += os.read(line, 4096)
    return data


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


def test_lidar_sends_a_scan_until_it_is_stopped(tmp_path: Path) -> None:
    lidar = RplidarA1()
    with SerialStandIn(tmp_path / "rplidar", lidar, 115200) as device, opened(device.path, termios.B115200) as line:
        os.write(line, b"\xa5\x52\xa5\x20")
        data = read(line, lambda data: len(data) > 800)
        assert data.startswith(b"\xa5\x5a\x03\x00\x00\x00\x06\x00\x00\x00\xa5\x5a\x05\x00\x00\x40\x81")
        first = data[17:22]
        assert (first[0] & 3, first[1] & 1) == (1, 1)  # a turn begins; the check bit
        assert int.from_bytes(first[3:5], "little") / 4 == 2000
        os.write(line, b"\xa5\x25\xa5\x52")
        health = b"\xa5\x5a\x03\x00\x00\x00\x06\x00\x00\x00"
        read(line, lambda data: data.endswith(health))
    assert not lidar.scans


def test_motor_board_answers_reads_keeps_writes_and_ignores_noise(tmp_path: Path) -> None:
    motors = MagniMotors(firmware=24)
    with SerialStandIn(tmp_path / "motors", motors, 38400) as device, opened(device.path, termios.B38400) as line:
        broken = bytearray(make_magni_packet(WRITE, BOTH_SPEED_SET, 77))
        broken[7] ^= 1
        os.write(line, b"\x7e\x00" + bytes(broken) + make_magni_packet(READ, FIRMWARE_VERSION))
        assert read(line, lambda data: len(data) >= 8) == make_magni_packet(RESPONSE, FIRMWARE_VERSION, 24)
        os.write(line, make_magni_packet(WRITE, BOTH_SPEED_SET, -5) + make_magni_packet(READ, BOTH_SPEED_SET))
        assert read(line, lambda data: len(data) >= 8) == make_magni_packet(RESPONSE, BOTH_SPEED_SET, -5)
    assert motors.writes == 1


def test_question_for_a_lidar_moves_no_motor(tmp_path: Path) -> None:
    motors = MagniMotors()
    with SerialStandIn(tmp_path / "motors", motors, 38400) as device:
        assert ask(device.path, "rplidar", 38400) == ""
        assert ask(device.path, "neato", 38400) == ""
    assert (motors.writes, motors.registers[BOTH_SPEED_SET]) == (0, 0)
