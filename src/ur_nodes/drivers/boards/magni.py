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
from typing import TYPE_CHECKING

from ur.robot.base import Base
from ur_nodes.drivers.boards.board import clip
from ur_nodes.drivers.frames import FrameReader, fixed
from ur_nodes.drivers.readings import Counts, DeviceIdentity, Motors, Power, Reading

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.plant import Plant

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

    def handshake(self) -> bytes:
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

    def shutdown(self) -> bytes:
        """Nothing: it is left as it was found."""
        return b""

    def receive(self, data: bytes) -> Iterator[Reading]:
        for frame in self._frames.receive(data):
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


# Stand-in: Magni's motor board, from the register map of Serial_Protocol.md (V3) and its worked examples of checksums.
# The units of speeds are those of the first versions of ubiquity_motor (TICS_PER_RADIAN 41.0058 / 2, four of them in a
# quarter tic, in 0.1 s), which its change e3b6120 says no encoder changes; the firmware caps them at 80, about 1 m/s.

CLOCK = 48e6  # ticks/s of its dead-man timer; a guess: the unit is documented as clock ticks of the microcontroller
ODOMETRY_PERIOD = 0.05  # s
COUNTS_PER_TURN = 257.64  # 41.004 a radian
SPEED_PER_TURN = 51.528  # for 1 turn a second
FASTEST = 80


class MagniFirmware:
    """See Firmware. `power`: the emergency stop is not pressed. `reports`: it sends its odometry by itself."""

    covers = frozenset(("battery",))

    def __init__(self, plant: Plant, *, version: int = 43, reports: bool = True) -> None:
        self._plant, self._version, self._reports = plant, version, reports
        self._scale = COUNTS_PER_TURN / (2.0 * math.pi * plant.base.wheels.radius)
        self._read = [0, 0]  # counts that were reported
        self._bytes = b""
        self._last_packet, self._reported = plant.time, plant.time
        self._dead_man = 0  # ticks; off until a driver has set it
        self.power = True

    def receive(self, data: bytes) -> bytes:
        self._bytes += data
        answer = b""
        while len(self._bytes) >= 8:
            packet = self._bytes[:8]
            if packet[0] != 0x7E or sum(packet[1:]) % 256 != 255 or packet[1] // 16 != 3:
                self._bytes = self._bytes[1:]
                continue
            self._bytes = self._bytes[8:]
            self._last_packet = self._plant.time
            answer += self._obey(packet[1] % 16, packet[2], packet[3:7])
        return answer

    def tick(self) -> bytes:
        now = self._plant.time
        if not self.power or (self._dead_man and now - self._last_packet > self._dead_man / CLOCK):
            self._plant.turn_wheels(0.0, 0.0)
        if not self._reports or now - self._reported < ODOMETRY_PERIOD - 1e-6:
            return b""
        self._reported = now
        return self._respond(0x30, self._read_counts())

    def _obey(self, kind: int, register: int, data: bytes) -> bytes:
        if kind == 0xB and register == 0x2A and self.power:
            left, right = (int.from_bytes(each, "big", signed=True) for each in (data[:2], data[2:]))
            self._commanded = self._plant.time
            rim = 2.0 * math.pi * self._plant.base.wheels.radius / SPEED_PER_TURN
            self._plant.turn_wheels(*(max(-FASTEST, min(FASTEST, each)) * rim for each in (left, right)))
        if kind == 0xB and register == 0x0D:
            self._dead_man = int.from_bytes(data, "big", signed=True)
        if kind != 0xA:
            return b""
        values = {
            0x22: self._version.to_bytes(4, "big"),
            0x23: round(self._plant.battery()[0] / 0.05127).to_bytes(4, "big"),
            0x32: bytes((0, 0, 0, self.power)),
            0x38: bytes((0, 0, 0, 1)),
        }
        return self._respond(register, self._read_counts() if register == 0x30 else values.get(register, bytes(4)))

    def _read_counts(self) -> bytes:
        total = [int(each * self._scale) for each in self._plant.rolled()]
        steps = [max(-32768, min(32767, now - before)) for now, before in zip(total, self._read, strict=True)]
        self._read = total
        return b"".join(each.to_bytes(2, "big", signed=True) for each in steps)

    @staticmethod
    def _respond(register: int, data: bytes) -> bytes:
        body = bytes((0x3C, register)) + data
        return b"\x7e" + body + bytes((255 - sum(body) % 256,))
