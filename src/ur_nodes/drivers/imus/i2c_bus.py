"""An I2C bus of the computer, by smbus2."""

from __future__ import annotations

from smbus2 import SMBus

from ur_nodes.drivers.imus.imu import I2cBus
from ur_nodes.drivers.lines.line import explain_error


class LinuxBus:
    """See I2cBus. Raises OSError where the bus cannot be opened."""

    def __init__(self, path: str) -> None:
        self._bus = SMBus(path)

    def read(self, address: int, register: int, count: int) -> bytes:
        """See I2cBus."""
        return bytes(self._bus.read_i2c_block_data(address, register, count))

    def write(self, address: int, register: int, value: int) -> None:
        """See I2cBus."""
        self._bus.write_byte_data(address, register, value)

    def close(self) -> None:
        """See I2cBus."""
        self._bus.close()


def open_bus(path: str) -> I2cBus | str:
    """Open a bus; or why it cannot be."""
    try:
        return LinuxBus(path)
    except OSError as problem:
        return explain_error(problem)
