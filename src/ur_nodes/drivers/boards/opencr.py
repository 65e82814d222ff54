"""The OpenCR board of a TurtleBot3 with the firmware for ROS 2: "DYNAMIXEL Protocol 2.0", and its control table.

Sources: the e-Manual of Robotis for the packets; `control_table.hpp` of turtlebot3_node and `turtlebot3.cpp` of OpenCR
for the table. A packet is FF FF FD 00, the id (200), a length of 16 bits, an instruction, its data, and a CRC of 16
bits (polynomial 8005); after FF FF FD in it a further FD is stuffed in. The data of a status (55) begin with an error.
Numbers are little-endian. Speeds are those of the base, in hundredths of m/s and of rad/s. The motors stop when the
heartbeat does not change for 0.5 s.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ur.robot.base import Base
from ur_nodes.drivers.boards.board import clip
from ur_nodes.drivers.frames import MORE, FrameReader
from ur_nodes.drivers.readings import Contacts, Counts, DeviceIdentity, Motors, Power, Reading

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.plant import Plant

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

    def handshake(self) -> bytes:
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

    def shutdown(self) -> bytes:
        """Nothing: without a heartbeat it rests."""
        return b""

    def receive(self, data: bytes) -> Iterator[Reading]:
        for frame in self._frames.receive(data):
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


# Stand-in: a TurtleBot3's OpenCR, from the e-Manual's page "DYNAMIXEL Protocol 2.0" and the firmware's table of
# addresses. A write is obeyed and answered, as `turtlebot3.cpp` of the firmware for ROS 2 does; speeds are limited to
# what 77 turns a minute of its motors give, and are zero unless the heartbeat has changed within 0.5 s.

HEARTBEAT_TIMEOUT = 0.5  # s
TURNS = 77.0 / 60.0  # a second
_SIZE = 180


def compute_crc(data: bytes) -> int:
    """CRC-16 as the e-Manual describes it, bit by bit."""
    register = 0
    for byte in data:
        register ^= byte << 8
        for _ in range(8):
            carry = register & 0x8000
            register = (register << 1) & 0xFFFF
            if carry:
                register ^= 0x8005
    return register


class OpenCrFirmware:
    """See Firmware. `power`: its motors answer; `counted` begins its positions."""

    covers = frozenset(("battery",))

    def __init__(self, plant: Plant, *, counted: int = 0, model: int = 1) -> None:
        self._plant, self._counted = plant, counted
        self._bytes = b""
        self._table = bytearray(_SIZE)
        self._table[0:7] = struct.pack("<HIB", 0x5000, model, 4)
        self._beat_time = -math.inf
        self.power = True

    def receive(self, data: bytes) -> bytes:
        self._bytes += data
        answer = b""
        while True:
            at = self._bytes.find(b"\xff\xff\xfd\x00")
            self._bytes = self._bytes[at:] if at >= 0 else self._bytes[-3:]
            if at < 0 or len(self._bytes) < 7:
                return answer
            size = 7 + self._bytes[5] + 256 * self._bytes[6]
            if size > 500 or size < 10:
                self._bytes = self._bytes[1:]
                continue
            if len(self._bytes) < size:
                return answer
            packet = self._bytes[:size]
            if compute_crc(packet[:-2]) != packet[-2] + 256 * packet[-1]:
                self._bytes = self._bytes[1:]
                continue
            self._bytes = self._bytes[size:]
            if packet[4] == 200:
                answer += self._obey(packet[7:-2].replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd"))

    def tick(self) -> bytes:
        if not self.power or self._plant.time - self._beat_time > HEARTBEAT_TIMEOUT:
            self._plant.turn_wheels(0.0, 0.0)
            self._beat_time = -math.inf
        return b""

    def _obey(self, body: bytes) -> bytes:
        if len(body) < 3:
            return b""
        code, address = body[0], body[1] + 256 * body[2]
        if code == 2 and len(body) == 5:
            volts = self._plant.battery()[0]
            scale = 4096 / (2.0 * math.pi * self._plant.base.wheels.radius)
            left, right = (_wrap(int(each * scale) + self._counted) for each in self._plant.rolled())
            self._table[18] = 0 if self.power else 255
            pressed = self._plant.bumpers()
            self._table[28:30] = bytes((pressed.get("front", False), pressed.get("back", False)))
            self._table[42:50] = struct.pack("<II", int(volts * 100), 5000)
            self._table[136:144] = struct.pack("<ii", left, right)
            length = body[3] + 256 * body[4]
            inside = address + length <= _SIZE
            return self._status(0 if inside else 7, bytes(self._table[address : address + length]) if inside else b"")
        if code == 3:
            data = body[3:]
            if address + len(data) > _SIZE or address < 19:
                return self._status(4, b"")
            before = self._table[19]
            self._table[address : address + len(data)] = data
            if self._table[19] != before:
                self._beat_time = self._plant.time
            if address <= 150 < address + len(data):
                self._turn()
            return self._status(0, b"")
        return self._status(2, b"")

    def _turn(self) -> None:
        if not self.power or self._beat_time == -math.inf:
            return
        linear, angular = (struct.unpack_from("<i", self._table, at)[0] / 100.0 for at in (150, 170))
        wheels = self._plant.base.wheels
        most = TURNS * 2.0 * math.pi * wheels.radius
        linear = max(-most, min(most, linear))
        across = max(-most, min(most, angular * wheels.separation / 2.0))
        self._plant.turn_wheels(linear - across, linear + across)

    @staticmethod
    def _status(problem: int, data: bytes) -> bytes:
        body = bytes((0x55, problem)) + data
        stuffed = body.replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")
        packet = b"\xff\xff\xfd\x00\xc8" + struct.pack("<H", len(stuffed) + 2) + stuffed
        return packet + struct.pack("<H", compute_crc(packet))


def _wrap(count: int) -> int:
    return (count + 0x80000000) % 0x100000000 - 0x80000000
