"""An I2C bus through smbus2, whose calls are played by the test."""

from typing import Any

from ur_nodes.drivers.imus.imu_driver_node import open_bus


class Bus:
    """What smbus2 opens."""

    def __init__(self, path: str) -> None:
        self.calls: list[Any] = [path]

    def read_i2c_block_data(self, *values: int) -> list[int]:
        self.calls.append(values)
        return [1, 2]

    def write_byte_data(self, *values: int) -> None:
        self.calls.append(values)

    def close(self) -> None:
        self.calls.append("closed")


def test_registers_are_read_and_written_at_an_address() -> None:
    made: list[Bus] = []

    def make(path: str) -> Any:
        made.append(Bus(path))
        return made[-1]

    bus = open_bus("/dev/i2c-1", make)
    assert not isinstance(bus, str)
    assert bus.read(0x28, 0x08, 2) == b"\x01\x02"
    bus.write(0x28, 0x3D, 8)
    bus.close()
    assert made[0].calls == ["/dev/i2c-1", (0x28, 0x08, 2), (0x28, 0x3D, 8), "closed"]


def test_bus_that_is_not_there_is_reported() -> None:
    assert open_bus("/dev/i2c-nonesuch") == "no such file or directory"
