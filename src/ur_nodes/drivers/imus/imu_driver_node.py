"""The driver of an inertial unit, as a node: the kind that the base file names, on its I2C bus."""

import sys
from collections.abc import Callable
from functools import partial

from smbus2 import SMBus

from ur.source.diagnostic import user_error
from ur_nodes.drivers.health import report_to_file
from ur_nodes.drivers.imus.imu import I2cBus
from ur_nodes.drivers.imus.imu_driver import ImuDriver
from ur_nodes.drivers.lines.line import explain_error
from ur_nodes.drivers.registry import IMUS, find_device, read_base
from ur_nodes.ports.node import Node
from ur_nodes.run import run


class LinuxBus:
    """See I2cBus."""

    def __init__(self, bus: SMBus) -> None:
        self._bus = bus

    def read(self, address: int, register: int, count: int) -> bytes:
        """See I2cBus."""
        return bytes(self._bus.read_i2c_block_data(address, register, count))

    def write(self, address: int, register: int, value: int) -> None:
        """See I2cBus."""
        self._bus.write_byte_data(address, register, value)

    def close(self) -> None:
        """See I2cBus."""
        self._bus.close()


def open_bus(path: str, make: Callable[[str], SMBus] = SMBus) -> I2cBus | str:
    """Open a bus; or why it cannot be."""
    try:
        return LinuxBus(make(path))
    except OSError as problem:
        return explain_error(problem)


def start(node: Node) -> None:
    """Read the parameters and open the bus. Raises UserError."""
    base = read_base(node.parameters)
    if base.imu is None:
        raise user_error(f"base {base.name!r} has no imu, expected one with `sensors: imu`", rule="no-imu")
    driver = next((each for each in base.drivers if each.part == "imu"), None)
    kind = node.parameters.text("imu", "") or (driver.protocol if driver else "")
    if kind not in IMUS:
        node.parameters.fail("imu", kind, f"one of {', '.join(IMUS)}", IMUS)
    path = find_device(node.parameters, driver)
    ImuDriver(node, base.imu, IMUS[kind](), (path, partial(open_bus, path)), report_to_file(node))


if __name__ == "__main__":
    sys.exit(run("imu_driver", start))
