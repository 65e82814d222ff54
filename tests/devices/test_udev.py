"""Udev rules: each device its own name, and common chips only where a base expects them."""

from pathlib import Path

import pytest

from ur.devices.known import Expected
from ur.devices.needs import write_rules
from ur.robot.base import list_bases, list_variants, load_base
from ur.robot.devices import expected_devices

LIBRARY = Path(__file__).parents[2] / "ubiquity_launches"


def test_common_chip_gets_a_name_only_where_the_base_expects_it() -> None:
    assert "rplidar" not in write_rules()
    rules = write_rules([Expected("lidar", "serial", "/dev/rplidar", "rplidar")])
    (line,) = [line for line in rules.splitlines() if "rplidar" in line]
    assert line == (
        'SUBSYSTEM=="tty", ATTRS{idVendor}=="10c4", ATTRS{idProduct}=="ea60", SYMLINK+="rplidar", '
        'GROUP="dialout", MODE="0660", ENV{ID_MM_DEVICE_IGNORE}="1"'
    )


@pytest.mark.parametrize("base", list_bases(LIBRARY))
def test_stable_names_in_base_files_are_made_by_the_rules(base: str) -> None:
    for variant in ("", *list_variants(LIBRARY, base)):
        expected = expected_devices(load_base(LIBRARY, base, variant))
        rules = write_rules(expected)
        for each in expected:
            if each.kind == "serial" and not each.path.startswith("/dev/tty"):
                assert f'SYMLINK+="{each.path.removeprefix("/dev/")}"' in rules


def test_chips_and_buses_of_a_header_are_opened_by_the_group_of_serial_devices() -> None:
    expected = [Expected("sonars", "gpio", "/dev/gpiochip0"), Expected("imu", "i2c", "/dev/i2c-1")]
    rules = write_rules(expected).removeprefix(write_rules())
    assert rules.splitlines() == [
        "# sonars",
        'SUBSYSTEM=="gpio", KERNEL=="gpiochip0", GROUP="dialout", MODE="0660"',
        "# imu",
        'SUBSYSTEM=="i2c-dev", KERNEL=="i2c-1", GROUP="dialout", MODE="0660"',
    ]
