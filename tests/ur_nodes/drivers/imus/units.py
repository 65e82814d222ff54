"""Inertial units as their registers: a second reading of the data sheets, with the faults of such units."""

from __future__ import annotations

import random
import struct
from dataclasses import dataclass, field


@dataclass
class Unit:
    """See I2cBus. `address` is where it answers; `turning` in rad/s, `force` in m/s^2, `orientation` w, x, y, z."""

    address: int
    turning: tuple[float, float, float] = (0.0, 0.0, 0.0)
    force: tuple[float, float, float] = (0.0, 0.0, 9.81)
    orientation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    plugged: bool = True
    noise: float = 0.0
    """The share of bytes with a flipped bit."""
    random: random.Random = field(default_factory=lambda: random.Random(1))
    registers: bytearray = field(default_factory=lambda: bytearray(256))
    closed: int = 0

    def open(self) -> Unit | str:
        return self if self.plugged else "no such file or directory"

    def read(self, address: int, register: int, count: int) -> bytes:
        self._check(address)
        assert count <= 32
        self.measure()
        data = self.registers[register : register + count]
        flip = self.random.random
        return bytes(each ^ (1 << self.random.randrange(8)) if flip() < self.noise else each for each in data)

    def write(self, address: int, register: int, value: int) -> None:
        self._check(address)
        self.registers[register] = value

    def close(self) -> None:
        self.closed += 1

    def measure(self) -> None:
        """Put what it measures into its registers."""

    def lose_power(self) -> None:
        self.registers = type(self)().registers  # type: ignore[call-arg]

    def _check(self, address: int) -> None:
        if not self.plugged or address != self.address:
            raise OSError(121, "Remote I/O error")


class BoschUnit(Unit):
    """A BNO055: tables 4-2 and 3-13 of its data sheet. Without a fusion mode its orientation is all zeros."""

    def __init__(self) -> None:
        super().__init__(0x28)
        self.registers[0:7] = bytes((0xA0, 0xFB, 0x32, 0x0F, 0x11, 0x03, 0x15))
        self.registers[0x3B] = 0x80
        self.registers[0x3D] = 0x10

    def measure(self) -> None:
        fused = self.registers[0x3D] & 0x0F >= 0x08
        scale = 900 if self.registers[0x3B] & 0x02 else 16 * 57.29578
        self.registers[0x08:0x0E] = struct.pack("<3h", *(round(each * 100) for each in self.force))
        self.registers[0x14:0x1A] = struct.pack("<3h", *(round(each * scale) for each in self.turning))
        values = [round(each * 16384) if fused else 0 for each in self.orientation]
        self.registers[0x20:0x28] = struct.pack("<4h", *values)


class InvenSenseUnit(Unit):
    """An MPU-6050: section 4 of its register map. It sleeps after it got power, and measures zeros then."""

    def __init__(self) -> None:
        super().__init__(0x68)
        self.registers[0x75] = 0x68
        self.registers[0x6B] = 0x40

    def measure(self) -> None:
        if self.registers[0x6B] & 0x40:
            self.registers[0x3B:0x49] = bytes(14)
            return
        per_g = 16384 >> (self.registers[0x1C] >> 3 & 3)
        per_degree = (131.0, 65.5, 32.8, 16.4)[self.registers[0x1B] >> 3 & 3]
        force = [round(each / 9.80665 * per_g) for each in self.force]
        turning = [round(each * 57.29578 * per_degree) for each in self.turning]
        self.registers[0x3B:0x49] = struct.pack(">7h", *force, -521, *turning)
