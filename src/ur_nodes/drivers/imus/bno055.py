"""Bosch BNO055: "BNO055 Intelligent 9-axis absolute orientation sensor", data sheet BST-BNO055-DS000, revision 1.4.

It fuses gyroscope and accelerometer itself (operation mode IMU). Its magnetometer is left out: beside motors and in
buildings it turns the robot. Registers are little-endian: force in hundredths of m/s^2, turning in 900ths of rad/s, and
the orientation w, x, y, z in 16384ths.
"""

import struct
import time
from collections.abc import Callable

from ur_nodes.drivers.imus.imu import I2cBus, InertialReading, UnitIdentity

ADDRESS = 0x28
_CHIP, _CHIP_ID = 0x00, 0xA0
_DATA, _COUNT = 0x08, 32  # to the end of the orientation: as many as SMBus reads at once
_PAGE, _UNITS, _MODE, _POWER, _TRIGGER = 0x07, 0x3B, 0x3D, 0x3E, 0x3F
_CONFIGURE, _IMU = 0x00, 0x08
_RADIANS = 0x02
_TO_CONFIGURE, _TO_MEASURE = 0.025, 0.02  # s; table 3-6: 19 and 7 ms
_FORCE, _TURNING, _UNIT = 100.0, 900.0, 16384.0
_LENGTH_ERROR = 0.02  # of the quaternion: a Raspberry Pi does not wait for the unit's clock, and reads nonsense then
_DEAD = 100  # readings without an orientation, after which it is set up again: it has lost its power


class Bno055:
    """See InertialDevice."""

    name = "BNO055"

    def __init__(self, sleep: Callable[[float], None] = time.sleep) -> None:
        self._sleep = sleep
        self._bad = 0

    def begin(self, bus: I2cBus) -> UnitIdentity:
        (chip,) = bus.read(ADDRESS, _CHIP, 1)
        if chip != _CHIP_ID:
            return UnitIdentity("", f"its chip id is {chip:#04x}, expected {_CHIP_ID:#04x}")
        bus.write(ADDRESS, _PAGE, 0)
        bus.write(ADDRESS, _MODE, _CONFIGURE)
        self._sleep(_TO_CONFIGURE)
        for register, value in ((_POWER, 0), (_TRIGGER, 0), (_UNITS, _RADIANS), (_MODE, _IMU)):
            bus.write(ADDRESS, register, value)
        self._sleep(_TO_MEASURE)
        software = bus.read(ADDRESS, 0x04, 2)
        return UnitIdentity(f"firmware {software[1]:x}.{software[0]:02x}")

    def read(self, bus: I2cBus) -> InertialReading | None:
        values = struct.unpack("<3h6x3h6x4h", bus.read(ADDRESS, _DATA, _COUNT))
        w, x, y, z = (each / _UNIT for each in values[6:])
        if abs(w * w + x * x + y * y + z * z - 1.0) > 2.0 * _LENGTH_ERROR:
            self._bad += 1
            if self._bad % _DEAD == 0:
                self.begin(bus)
            return None
        self._bad = 0
        force = (values[0] / _FORCE, values[1] / _FORCE, values[2] / _FORCE)
        turning = (values[3] / _TURNING, values[4] / _TURNING, values[5] / _TURNING)
        length = (w * w + x * x + y * y + z * z) ** 0.5
        return InertialReading(turning, force, (x / length, y / length, z / length, w / length))
