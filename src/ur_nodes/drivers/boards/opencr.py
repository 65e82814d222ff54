"""The OpenCR board of a TurtleBot3 with the firmware for ROS 2: "DYNAMIXEL Protocol 2.0", and its control table.

Sources: the e-Manual of Robotis for the packets; `control_table.hpp` of turtlebot3_node and `turtlebot3.cpp` of OpenCR
for the table. A packet is FF FF FD 00, the id (200), a length of 16 bits, an instruction, its data, and a CRC of 16
bits (polynomial 8005); after FF FF FD in it a further FD is stuffed in. The data of a status (55) begin with an error.
Numbers are little-endian. Speeds are those of the base, in hundredths of m/s and of rad/s. The motors stop when the
heartbeat does not change for 0.5 s.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

from ur.robot.base import Base
from ur_nodes.drivers.boards.board import clip
from ur_nodes.drivers.frames import MORE, FrameReader
from ur_nodes.drivers.readings import Contacts, Counts, DeviceIdentity, Motors, Power, Reading

ID, READ, WRITE, STATUS = 200, 0x02, 0x03, 0x55
MODEL_NUMBER = 0x5000
COUNTS_PER_TURN = 4096.0
_HEADER = b"\xff\xff\xfd\x00"
_LONGEST = 160
_MODEL, _STATE, _POSITIONS = (0, 7), (18, 32), (136, 8)  # address and length; a status is known by its length
_TORQUE, _HEARTBEAT, _VELOCITY = 149, 19, 150
_HEARTBEATS = 2  # beats
_SECOND = 12  # beats between two questions for the state
_MODELS = {1: "Burger", 2: "Waffle"}
_POLYNOMIAL = 0x8005
_FASTEST = 500  # cm/s and hundredths of rad/s


def _make_table() -> tuple[int, ...]:
    table = []
    for value in range(256):
        value <<= 8
        for _ in range(8):
            value = (value << 1 ^ (_POLYNOMIAL if value & 0x8000 else 0)) & 0xFFFF
        table.append(value)
    return tuple(table)


_TABLE = _make_table()


class OpenCr:
    """See MotorBoard."""

    name = "OpenCR board of a TurtleBot3"
    baud = 1_000_000
    period = 0.04
    counts_per_turn = COUNTS_PER_TURN

    def __init__(self, base: Base) -> None:
        self._separation = base.wheels.separation
        self._frames = FrameReader(_HEADER, _measure, _is_valid, _LONGEST)
        self._beats = 0
        self._over = (0.0, 0.0)  # hundredths that the last commands left out

    @property
    def rejected(self) -> int:
        return self._frames.rejected

    def greet(self) -> bytes:
        """Switch the torque of its motors on, and ask for its model."""
        return make_packet(WRITE, _TORQUE, b"\x01") + _read(_MODEL) + _read(_STATE)

    def drive(self, left: float, right: float) -> bytes:
        self._beats += 1
        data = self._move((left + right) / 2.0 * 100.0, (right - left) / self._separation * 100.0)
        if self._beats % _HEARTBEATS == 0:
            data += make_packet(WRITE, _HEARTBEAT, bytes((self._beats // _HEARTBEATS & 0xFF,)))
        if self._beats % _SECOND == 0:
            data += _read(_STATE)
        return data + _read(_POSITIONS)

    def _move(self, forward: float, turn: float) -> bytes:
        """Whole hundredths whose mean is what was asked for: what is left over goes to the next beat."""
        wanted = [speed + over if speed else 0.0 for speed, over in zip((forward, turn), self._over, strict=True)]
        units = [clip(each, _FASTEST) for each in wanted]
        left_over = [max(-0.5, min(0.5, each - unit)) for each, unit in zip(wanted, units, strict=True)]
        self._over = (left_over[0], left_over[1])
        return make_packet(WRITE, _VELOCITY, struct.pack("<6i", units[0], 0, 0, 0, 0, units[1]))

    def stop(self) -> bytes:
        """See MotorBoard. Zeros first: they end a packet that was cut off."""
        return bytes(40) + make_packet(WRITE, _VELOCITY, bytes(24))

    def leave(self) -> bytes:
        """Nothing: without a heartbeat it rests."""
        return b""

    def take(self, data: bytes) -> Iterator[Reading]:
        for frame in self._frames.take(data):
            body = frame[7:-2].replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")
            if body[:1] == bytes((STATUS,)) and len(body) > 2 and not body[1] & 0x7F:
                yield from _read_status(body[2:])


def make_packet(instruction: int, address: int, data: bytes, number: int = ID) -> bytes:
    """A packet for the device of a number, with its CRC."""
    body = bytes((instruction, *address.to_bytes(2, "little"))) + data
    body = body.replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")
    packet = _HEADER + bytes((number, *(len(body) + 2).to_bytes(2, "little"))) + body
    return packet + check(packet).to_bytes(2, "little")


def check(data: bytes) -> int:
    """The CRC of 16 bits, polynomial 8005, which begins with 0."""
    value = 0
    for byte in data:
        value = (value << 8 & 0xFFFF) ^ _TABLE[value >> 8 ^ byte]
    return value


def _read(item: tuple[int, int]) -> bytes:
    address, length = item
    return make_packet(READ, address, length.to_bytes(2, "little"))


def _read_status(data: bytes) -> Iterator[Reading]:
    if len(data) == _POSITIONS[1]:
        yield Counts(*struct.unpack("<ii", data))
    elif len(data) == _MODEL[1]:
        number, model, firmware = struct.unpack("<HIB", data)
        problem = "" if number == MODEL_NUMBER else f"model {number:#x}, expected {MODEL_NUMBER:#x}: another firmware"
        help_ = "; flash the one for ROS 2, as Robotis' e-Manual shows" if problem else ""
        yield DeviceIdentity(f"{_MODELS.get(model, 'of no known model')}, firmware {firmware}", problem + help_)
    elif len(data) == _STATE[1]:
        state, bumpers = struct.unpack_from("<b", data)[0], data[10:12]
        volts = int.from_bytes(data[24:28], "little")
        yield Motors(state >= 0, "" if state >= 0 else "its motors do not answer; is its power switch on?")
        yield Contacts("bumper", (("front", bool(bumpers[0])), ("back", bool(bumpers[1]))))
        if 0 < volts < 10_000:
            yield Power(volts / 100.0)


def _measure(frame: bytes) -> int:
    if len(frame) < 7:
        return MORE
    return 7 + int.from_bytes(frame[5:7], "little")


def _is_valid(frame: bytes) -> bool:
    return len(frame) >= 11 and check(frame[:-2]) == int.from_bytes(frame[-2:], "little")
