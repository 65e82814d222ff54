"""InvenSense MPU-6050: "MPU-6000 and MPU-6050 Register Map and Descriptions", revision 4.2.

Gyroscope and accelerometer, no orientation. Registers are big-endian: force (x, y, z), temperature, turning (x, y, z).
Its gyroscope is off by up to 20 degrees/s, so what it shows while the robot rests is taken as zero.
"""

import math
import struct
import time
from collections.abc import Callable

from ur_nodes.drivers.imus.imu import I2cBus, InertialReading, Triple, UnitIdentity

ADDRESS = 0x68
STILL = 50  # readings at rest that make the zero
_DIVIDER, _FILTER, _TURNING_SCALE, _FORCE_SCALE, _DATA, _POWER, _WHO = 0x19, 0x1A, 0x1B, 0x1C, 0x3B, 0x6B, 0x75
_COUNT = 14
_NAMES = {0x68: "MPU-6050", 0x70: "MPU-6500", 0x71: "MPU-9250"}  # the later ones have the same registers
_SETTINGS = (
    (_POWER, 0x01),  # awake, with the clock of a gyroscope
    (_DIVIDER, 4),  # 200 measurements a second
    (_FILTER, 3),  # 44 Hz
    (_TURNING_SCALE, 0x08),  # 500 degrees/s
    (_FORCE_SCALE, 0x08),  # 4 g
)
_WAKING = 0.1  # s
_TURNING = 65.5 * 180.0 / math.pi  # for 1 rad/s
_FORCE = 8192.0 / 9.80665  # for 1 m/s^2
_SPREAD = 0.02  # rad/s within which it rests


class Mpu6050:
    """See InertialDevice. It reads nothing until it has rested for a second."""

    name = "MPU-6050"

    def __init__(self, sleep: Callable[[float], None] = time.sleep) -> None:
        self._sleep = sleep
        self._seen: list[Triple] = []
        self._zero: Triple | None = None

    def begin(self, bus: I2cBus) -> UnitIdentity:
        (kind,) = bus.read(ADDRESS, _WHO, 1)
        if kind not in _NAMES:
            return UnitIdentity("", f"its id is {kind:#04x}, expected one of {', '.join(map(hex, _NAMES))}")
        for register, value in _SETTINGS:
            bus.write(ADDRESS, register, value)
            self._sleep(_WAKING if register == _POWER else 0.0)
        self._seen.clear()
        return UnitIdentity(f"{_NAMES[kind]}, keep it at rest for a second")

    def read(self, bus: I2cBus) -> InertialReading | None:
        """See InertialDevice. All zeros are those of a unit that sleeps: it has lost its power."""
        data = bus.read(ADDRESS, _DATA, _COUNT)
        if not any(data):
            self.begin(bus)
            return None
        values = struct.unpack(">3hh3h", data)
        force = (values[0] / _FORCE, values[1] / _FORCE, values[2] / _FORCE)
        turning = (values[4] / _TURNING, values[5] / _TURNING, values[6] / _TURNING)
        zero = self._zero or self._find_zero(turning)
        if zero is None:
            return None
        return InertialReading((turning[0] - zero[0], turning[1] - zero[1], turning[2] - zero[2]), force)

    def _find_zero(self, turning: Triple) -> Triple | None:
        """The mean of the first STILL readings in a row that are nearly equal."""
        self._seen = [*self._seen[-STILL + 1 :], turning]
        axes = tuple(zip(*self._seen, strict=True))
        if len(self._seen) < STILL or any(max(axis) - min(axis) > _SPREAD for axis in axes):
            return None
        x, y, z = (math.fsum(axis) / STILL for axis in axes)
        self._zero = (x, y, z)
        return self._zero
