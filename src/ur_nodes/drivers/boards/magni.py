"""The motor board of Ubiquity Robotics' Magni: "Ubiquity Robotics Motor Controller Serial Protocol V3".

Packets of 8 bytes: 7E, protocol 3 and the kind, a register, 32 bits of data (big-endian), and a checksum that makes the
low byte of the sum without the 7E FF. The units are those of ubiquity_motor's motor_hardware.cc. Speeds are quarters of
a count in 100 ms, of counts half as fine as those of the odometry; the left one is in the upper half. A report of the
odometry has the counts since the last one; boards send it by themselves. The dead-man timer stops the motors when no
packet arrives for so many clock ticks, says ubiquity_motor's README.md.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator

from ur.robot.base import Base
from ur_nodes.drivers.boards.board import clip
from ur_nodes.drivers.frames import FrameReader, fixed
from ur_nodes.drivers.readings import Counts, DeviceIdentity, Motors, Power, Reading

COUNTS_PER_RADIAN = 41.004  # of the odometry, for the wheels with a gear of 4.294 and encoders with 6 states
SPEED_PER_RADIAN = COUNTS_PER_RADIAN / 2.0 * 4.0 / 10.0  # 8.2 for 1 rad/s
OLDEST_FIRMWARE = 35  # the first one whose encoders have 6 states
VOLTS = 0.05127  # for each unit of the register; ubiquity_motor, battery_voltage_multiplier
_READ, _WRITE, _RESPONSE = 0x3A, 0x3B, 0x3C
_DEAD_MAN, _FIRMWARE, _BATTERY, _SPEEDS, _ODOMETRY, _MOTOR_POWER, _OPTIONS = 0x0D, 0x22, 0x23, 0x2A, 0x30, 0x32, 0x38
_DEAD_MAN_TICKS = 9_600_000  # 0.2 s at 48 MHz, a guess; from 24 to 80 MHz it is 0.12 to 0.4 s, three beats or more
_SIX_STATES, _THIN_WHEELS = 1, 2  # options
_PACKET = struct.Struct(">BBBi")
_SIZE = 8
_PATIENCE = 1  # beats without a report of the odometry, after which it is asked for
_SECOND = 25  # beats


class Magni:
    """See MotorBoard."""

    name = "Magni's motor board"
    baud = 38400
    period = 0.04

    def __init__(self, base: Base) -> None:
        self.counts_per_turn = COUNTS_PER_RADIAN * 2.0 * math.pi
        self._radius = base.wheels.radius
        self._frames = FrameReader(b"\x7e", fixed(_SIZE), _is_valid, _SIZE)
        self._counts = (0, 0)
        self._silent = self._beats = 0
        self._left = [0.0, 0.0]  # of the last speeds

    @property
    def rejected(self) -> int:
        return self._frames.rejected

    def greet(self) -> bytes:
        """Start its dead-man timer, and ask for the firmware's version and the options of the board."""
        watchdog = make_packet(_WRITE, _DEAD_MAN, _DEAD_MAN_TICKS)
        return watchdog + make_packet(_READ, _FIRMWARE) + make_packet(_READ, _OPTIONS)

    def drive(self, left: float, right: float) -> bytes:
        self._beats += 1
        self._silent += 1
        speeds = self._round(left / self._radius * SPEED_PER_RADIAN, right / self._radius * SPEED_PER_RADIAN)
        data = make_packet(_WRITE, _SPEEDS, *struct.unpack(">i", struct.pack(">hh", *speeds)))
        if self._silent > _PATIENCE:
            data += make_packet(_READ, _ODOMETRY)
        if self._beats % _SECOND == 0:
            data += make_packet(_READ, _BATTERY)
        if self._beats % _SECOND == _SECOND // 2:
            data += make_packet(_READ, _MOTOR_POWER)
        return data

    def _round(self, *speeds: float) -> list[int]:
        """Whole units, about 12 mm/s, whose mean is what was asked for: what is left over goes to the next beat."""
        wanted = [speed + left if speed else 0.0 for speed, left in zip(speeds, self._left, strict=True)]
        units = [clip(each, 0x7FFF) for each in wanted]
        self._left = [max(-0.5, min(0.5, each - unit)) for each, unit in zip(wanted, units, strict=True)]
        return units

    def stop(self) -> bytes:
        """See MotorBoard. Twice: the first one may complete a packet that was cut off."""
        return make_packet(_WRITE, _SPEEDS) * 2

    def leave(self) -> bytes:
        """Nothing: it is left as it was found."""
        return b""

    def take(self, data: bytes) -> Iterator[Reading]:
        for frame in self._frames.take(data):
            _, kind, register, value = _PACKET.unpack_from(frame)
            if kind == _RESPONSE:
                yield from self._read(register, value)

    def _read(self, register: int, value: int) -> Iterator[Reading]:
        if register == _ODOMETRY:
            self._silent = 0
            steps = struct.unpack(">hh", struct.pack(">i", value))
            self._counts = (self._counts[0] + steps[0], self._counts[1] + steps[1])
            yield Counts(*self._counts, bits=64)
        elif register == _FIRMWARE:
            expected = f"firmware {value}, expected {OLDEST_FIRMWARE} or later: upgrade it as Ubiquity Robotics says"
            yield DeviceIdentity(f"firmware {value}", expected if value < OLDEST_FIRMWARE else "")
        elif register == _OPTIONS:
            known = value & (_SIX_STATES | _THIN_WHEELS) == _SIX_STATES
            expected = f"options {value:#x}, expected encoders with 6 states and wheels of the standard type"
            yield DeviceIdentity(f"options {value:#x}", "" if known else expected)
        elif register == _BATTERY and value > 0:
            yield Power(value * VOLTS)
        elif register == _MOTOR_POWER:
            yield Motors(bool(value & 1), "" if value & 1 else "its motors have no power (emergency stop?)")


def make_packet(kind: int, register: int, value: int = 0) -> bytes:
    """A packet with its checksum."""
    packet = _PACKET.pack(0x7E, kind, register, value)
    return packet + bytes((0xFF - (sum(packet[1:]) & 0xFF),))


def _is_valid(frame: bytes) -> bool:
    return frame[1] >> 4 == 3 and sum(frame[1:]) & 0xFF == 0xFF
