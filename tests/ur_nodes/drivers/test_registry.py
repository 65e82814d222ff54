"""The rows of `OWN_DRIVERS`: each names a driver with the baud rate of its row, and boards and lidars a stand-in."""

import ast
from importlib import import_module
from pathlib import Path

import pytest

from ur.robot.base.calibration import Calibration
from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.robot.robot_file import parse_robot_file
from ur_nodes.drivers.registry import find_calibration
from ur_nodes.memory.bus import Bus

SERIAL = [name for name, row in OWN_DRIVERS.items() if row.sensor in ("", "lidar")]
SIGNPOST = "\n# Stand-in: "


@pytest.mark.parametrize("name", OWN_DRIVERS)
def test_row_names_a_driver_of_its_baud_rate(name: str) -> None:
    module, _, attribute = OWN_DRIVERS[name].entry_point.partition(":")
    driver = getattr(import_module(f"ur_nodes.drivers.{module}"), attribute)
    assert getattr(driver, "baud", 0) == OWN_DRIVERS[name].baud


@pytest.mark.parametrize("name", SERIAL)
def test_stand_in_is_a_second_reading_of_the_document_and_shares_no_code_with_the_driver(name: str) -> None:
    module, _, attribute = OWN_DRIVERS[name].entry_point.partition(":")
    found = import_module(f"ur_nodes.drivers.{module}")
    text = Path(str(found.__file__)).read_text(encoding="utf-8")
    driver, signpost, stand_in = text.partition(SIGNPOST)
    assert signpost, f"{module}: write '{SIGNPOST.strip()}' and its document between the driver and its stand-in"
    assert f"{attribute}Firmware" in stand_in
    own = {
        each
        for node in ast.parse(driver).body
        if not isinstance(node, ast.Import | ast.ImportFrom | ast.If)
        for each in _named(node)
    }
    assert own & {node.id for node in ast.walk(ast.parse(f"# {stand_in}")) if isinstance(node, ast.Name)} == set()


def _named(node: ast.stmt) -> set[str]:
    if isinstance(node, ast.ClassDef | ast.FunctionDef):
        return {node.name}
    return {each.id for each in ast.walk(node) if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)}


def test_driver_on_a_robot_uses_its_calibration_and_that_of_a_simulated_device_does_not() -> None:
    text = "name: bob\nbase: create2\nvariant: lidar\ncalibration: {lidar_yaw: 0.05, wheel_radius: 1.02}\n"

    def find(base: str, folder: str = "/dev") -> Calibration:
        bus = Bus()
        bus.parameters |= {"/driver/base": base, "/driver/device_folder": folder}
        return find_calibration(bus.node("driver").parameters, lambda: parse_robot_file(text))

    assert find("create2") == Calibration(0.05, 1.02)
    assert find("create2", "/tmp/devices") == find("stage") == Calibration()
