"""The motor board of Ubiquity Robotics' Magni: "Ubiquity Robotics Motor Controller Serial Protocol V3".

Packets of 8 bytes: 7E, protocol 3 and the kind, a register, 32 bits of data (big-endian), and a checksum that makes the
low byte of the sum without the 7E FF. Speeds are counts of a quarter in 100 ms, the left one in the upper half. A
report of the odometry has the counts since the last one; boards send it by themselves, and older ones when they are
asked.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator

from ur.robot.base import Base
from ur_nodes.drivers.boards.board import clip, scale_of
from ur_nodes.drivers.frames import FrameReader, fixed
from ur_nodes.drivers.readings import Counts, Identity, Motors, Power, Reading

COUNTS_PER_RADIAN = 41.004  # of the wheels with a gear of 4.294; ubiquity_motor, motor_hardware.cc
OLDEST_FIRMWARE = 28  # that ubiquity_motor accepts
VOLTS = 0.05127  # for each unit of the register; ubiquity_motor, battery_voltage_multiplier
_READ, _WRITE, _RESPONSE = 0x3A, 0x3B, 0x3C
_FIRMWARE, _BATTERY, _SPEEDS, _ODOMETRY, _MOTOR_POWER = 0x22, 0x23, 0x2A, 0x30, 0x32
_PACKET = struct.Struct(">BBBi")
_SIZE = 8
_PATIENCE = 1  # beats without a report of the odometry, after which it is asked for
_SECOND = 25  # beats
_FIRST_WITH_POWER_STATE = 35  # firmware that reports whether the motors have power


class Magni:
    """See Board."""

    name = "Magni's motor board"
    baud = 38400
    period = 0.04
    own_watchdog = 0.0  # the page on this driver says why

    def __init__(self, base: Base) -> None:
        self.counts_per_turn = COUNTS_PER_RADIAN * 2.0 * math.pi
        self._scale = scale_of(base, self.counts_per_turn)
        self._frames = FrameReader(b"\x7e", fixed(_SIZE), _is_valid, _SIZE)
        self._counts = (0, 0)
        self._silent = self._beats = self._firmware = 0

    def greet(self) -> bytes:
        """Ask for the firmware's version."""
        return make_packet(_READ, _FIRMWARE)

    def drive(self, left: float, right: float) -> bytes:
        """See Board."""
        self._beats += 1
        self._silent += 1
        speeds = (clip(each * self._scale.counts_per_metre * 4.0 / 10.0, 0x7FFF) for each in (left, right))
        data = make_packet(_WRITE, _SPEEDS, *struct.unpack(">i", struct.pack(">hh", *speeds)))
        if self._silent > _PATIENCE:
            data += make_packet(_READ, _ODOMETRY)
        if self._beats % _SECOND == 0:
            data += make_packet(_READ, _BATTERY)
        if self._beats % _SECOND == _SECOND // 2 and self._firmware >= _FIRST_WITH_POWER_STATE:
            data += make_packet(_READ, _MOTOR_POWER)
        return data

    def stop(self) -> bytes:
        """See Board. Twice: the first one may complete a packet that was cut off."""
        return make_packet(_WRITE, _SPEEDS) * 2

    def leave(self) -> bytes:
        """Nothing: it is left as it was found."""
        return b""

    def take(self, data: bytes) -> Iterator[Reading]:
        """See Board."""
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
            self._firmware = value
            expected = f"firmware {value}, expected {OLDEST_FIRMWARE} or later: upgrade it as Ubiquity Robotics says"
            yield Identity(f"firmware {value}", expected if value < OLDEST_FIRMWARE else "")
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
