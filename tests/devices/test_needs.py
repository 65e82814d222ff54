"""What a base needs, compared with what is plugged in."""

from dataclasses import replace

import pytest

from ur.devices.known import Device, DeviceHolder, DeviceSnapshot, Expected
from ur.devices.needs import State, examine, list_problems

LIDAR = Device(
    "/dev/ttyUSB0", "serial", "10c4:ea60", links=("/dev/rplidar",), mode=0o660, owner="root", group="dialout"
)
NEED = Expected("lidar", "serial", "/dev/rplidar", "rplidar")
THERE = DeviceSnapshot("ros", frozenset({"dialout"}), frozenset({"dialout"}), (LIDAR,))


def with_lidar(**changes: object) -> DeviceSnapshot:
    return replace(THERE, devices=(replace(LIDAR, **changes),))  # type: ignore[arg-type] # a test's own keywords


@pytest.mark.parametrize(
    ("snapshot", "state", "text", "help"),
    [
        (THERE, "ready", "/dev/rplidar: probably Slamtec RPLIDAR", ""),
        (replace(THERE, devices=()), "missing", "the lidar needs /dev/rplidar", "USB id 10c4:ea60"),
        (with_lidar(links=()), "unnamed", "/dev/ttyUSB0 may be it", "ur robot setup"),
        (with_lidar(allowed=False), "forbidden", "ros may not open /dev/ttyUSB0", "dialout"),
        (
            with_lidar(holders=(DeviceHolder(9, "agetty", "root"),)),
            "busy",
            "in use by agetty (process 9)",
            "disable --now serial-getty@ttyUSB0.service",
        ),
        (
            replace(THERE, devices=(LIDAR, replace(LIDAR, path="/dev/ttyUSB1", links=()))),
            "ambiguous",
            "/dev/ttyUSB0 and /dev/ttyUSB1 could both be /dev/rplidar",
            "by-id",
        ),
    ],
)
def test_expected_device_is_reported_with_what_to_do(
    snapshot: DeviceSnapshot, state: State, text: str, help: str
) -> None:
    (need,) = examine(snapshot, [NEED])
    assert need.state == state
    assert text in need.message
    assert help in need.help


@pytest.mark.parametrize(
    ("expected", "text", "help"),
    [
        (Expected("imu", "i2c", "/dev/i2c-1"), "the imu needs /dev/i2c-1, which is not there", "dtparam=i2c_arm=on"),
        (Expected("sonars", "gpio", "/dev/gpiochip0"), "the board of sonars needs /dev/gpiochip0", "as a Raspberry Pi"),
    ],
)
def test_bus_or_chip_that_is_not_there_is_named_with_what_to_do(expected: Expected, text: str, help: str) -> None:
    (need,) = examine(THERE, [expected])
    assert need.message.startswith(text)
    assert help in need.help


def test_driver_that_runs_is_no_problem() -> None:
    (need,) = examine(with_lidar(holders=(DeviceHolder(9, "rplidarNode", "ros"),)), [NEED])
    assert need.state == "ready"


def test_any_camera_serves_a_base_that_needs_one() -> None:
    need = Expected("raspicam", "camera")
    assert examine(THERE, [need])[0].state == "missing"
    camera = Device("/dev/video0", "camera")
    assert examine(replace(THERE, devices=(camera,)), [need])[0].state == "ready"


def test_group_that_was_joined_just_now_needs_a_login() -> None:
    snapshot = replace(with_lidar(allowed=False), groups=frozenset())
    ((state, _, help),) = list_problems(snapshot)
    assert (state, help) == ("forbidden", "ros is in the group dialout since this session began: log in again")
    ((_, _, help),) = list_problems(replace(snapshot, member=frozenset()))
    assert help == "sudo usermod --append --groups dialout ros, then log in again"


def test_doctor_misses_the_unplugged_device_and_accepts_it_when_it_is_back() -> None:
    expected = Expected("lidar", "serial", "/dev/rplidar", "rplidar", 115200)
    plugged = Device("/dev/ttyUSB0", "serial", "10c4:ea60", links=("/dev/rplidar",))
    back = Device("/dev/ttyUSB1", "serial", "10c4:ea60", links=("/dev/rplidar",))
    states = [examine(DeviceSnapshot("pat", devices=found), [expected])[0].state for found in ((plugged,), (), (back,))]
    assert states == ["ready", "missing", "ready"]
