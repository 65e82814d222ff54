"""The rules about devices, on a computer whose devices are stand-ins."""

from dataclasses import replace
from pathlib import Path

from tests.devices.stand_ins.firmwares import MagniMotors, RplidarA1
from tests.devices.stand_ins.serial_stand_in import SerialStandIn
from tests.devices.tree import Tree, TreeShell
from tests.robot.doctor.pairs import PAIR

from ur.devices.known import Expected
from ur.robot.devices import inspect_devices
from ur.robot.doctor.rules import diagnose

EXPECTED = (
    Expected("base", "serial", "/dev/ttyAMA0", "pi-uart", 38400),
    Expected("lidar", "serial", "/dev/rplidar", "rplidar", 115200),
)


def find_rules(tree: Tree) -> list[str]:
    pair = replace(PAIR, devices=inspect_devices(TreeShell(tree)), expected=EXPECTED)
    return [finding.rule for finding in diagnose(pair)]


def test_doctor_follows_a_lidar_that_is_unplugged_and_back_behind_another_file(tmp_path: Path) -> None:
    tree, motors = Tree(tmp_path), MagniMotors()
    lidar = RplidarA1()
    tree.solder("ttyAMA0")
    (tmp_path / "dev/ttyAMA0").unlink()
    with SerialStandIn(tmp_path / "dev/ttyAMA0", motors, 38400):
        tree.plug("1-1.2", "10c4:ea60", tty="ttyUSB0")
        (tmp_path / "dev/ttyUSB0").unlink()
        with SerialStandIn(tmp_path / "dev/ttyUSB0", lidar, 115200):
            assert find_rules(tree) == ["device-without-name"]
            tree.link("rplidar", "ttyUSB0")
            assert find_rules(tree) == []
        tree.unplug("1-1.2", "ttyUSB0")  # the driver still has it open: the next one gets another file
        assert find_rules(tree) == ["missing-device"]
        tree.plug("1-1.2", "10c4:ea60", tty="ttyUSB1")
        (tmp_path / "dev/ttyUSB1").unlink()
        (tmp_path / "dev/rplidar").unlink()
        tree.link("rplidar", "ttyUSB1")
        with SerialStandIn(tmp_path / "dev/ttyUSB1", lidar, 115200):
            assert find_rules(tree) == []
    assert (motors.writes, lidar.requests) == (0, b"")  # the doctor asks no device
