"""The nodes of drivers: what they take from the base file and from parameters, and what they refuse."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from ur.source.diagnostic import UserError
from ur_nodes.drivers import base_driver_node, lidar_driver_node
from ur_nodes.drivers.imus import imu_driver_node
from ur_nodes.drivers.sonars import sonar_driver_node
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.ports.node import Node

Start = Callable[[Node], None]
BASE, LIDAR = base_driver_node.start, lidar_driver_node.start
SONARS, IMU = sonar_driver_node.start, imu_driver_node.start


def start(node_start: Start, **parameters: Any) -> MemoryNode:
    """A node that was started with parameters, a moment later."""
    bus = Bus()
    bus.load_parameters("/driver", parameters)
    node = bus.node("driver")
    node_start(node)
    bus.run(0.2)
    return node


@pytest.mark.parametrize(("node_start", "name"), [(BASE, "create"), (LIDAR, "rplidar")], ids=["the base", "its lidar"])
def test_device_of_the_base_file_is_opened_in_the_folder_of_devices(
    node_start: Start, name: str, tmp_path: Path
) -> None:
    node = start(node_start, base="create2", variant="lidar", device_folder=str(tmp_path))
    (line,) = [text for _, text in node.lines]
    assert line.startswith(f"{tmp_path}/{name}: no such file or directory; expected ")
    assert "ur devices" in line


@pytest.mark.parametrize(
    ("node_start", "own", "expected"),
    [
        (SONARS, {"base": "magni"}, "expected the GPIO chip of a Raspberry Pi"),
        (IMU, {"base": "stage", "imu": "bno055"}, "expected a BNO055"),
    ],
    ids=["sonars", "an inertial unit"],
)
def test_chip_and_bus_are_those_of_the_parameters(
    node_start: Start, own: dict[str, Any], expected: str, tmp_path: Path
) -> None:
    node = start(node_start, device=str(tmp_path / "chip"), **own)
    (line,) = [text for _, text in node.lines]
    assert line.startswith(f"{tmp_path}/chip: no such file or directory; {expected}")


def test_parameters_name_another_device_board_and_kind_of_lidar(tmp_path: Path) -> None:
    own = {"base": "create2", "variant": "lidar", "device": str(tmp_path / "one"), "baud": 9600}
    assert "one: no such file or directory; expected Arduino" in start(BASE, board="arduino", **own).lines[0][1]
    assert "one: no such file or directory; expected LDROBOT" in start(LIDAR, lidar="ld06", **own).lines[0][1]


@pytest.mark.parametrize(
    ("node_start", "parameters", "message"),
    [
        (BASE, {"base": "stage"}, "expected one of arduino, create2, loki, magni"),
        (BASE, {"base": "create2", "board": "creat2"}, "expected one of arduino, create2, loki, magni"),
        (BASE, {"base": "create2", "device": "ttyUSB0"}, "expected a device file"),
        (LIDAR, {"base": "create2"}, "base 'create2' has no lidar"),
        (SONARS, {"base": "loki", "sonars": "magni_sonars"}, "base 'loki' has 16 sonars, expected the 5 of magni"),
        (SONARS, {"base": "magni", "sonars": "nonesuch"}, "expected one of magni_sonars"),
        (IMU, {"base": "magni", "imu": "bno055"}, "base 'magni' has no imu"),
        (IMU, {"base": "stage", "imu": "nonesuch"}, "expected one of bno055, mpu6050"),
        (
            LIDAR,
            {"base": "create2", "variant": "lidar", "lidar": "sick"},
            "expected one of rplidar, rplidar_express, hokuyo",
        ),
    ],
)
def test_what_is_no_board_lidar_or_device_is_refused(
    node_start: Start, parameters: dict[str, Any], message: str
) -> None:
    with pytest.raises(UserError, match=message):
        start(node_start, **parameters)
