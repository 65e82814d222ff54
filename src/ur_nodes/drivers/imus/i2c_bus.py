"""An I2C bus of the computer, by smbus2."""

from __future__ import annotations

from collections.abc import Callable

from smbus2 import SMBus

from ur_nodes.drivers.imus.imu import I2cBus
from ur_nodes.drivers.lines.line import explain_error


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
