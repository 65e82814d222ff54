"""A TurtleBot3's OpenCR, from the e-Manual's page "DYNAMIXEL Protocol 2.0" and the firmware's table of addresses.

A write is obeyed and answered, as `turtlebot3.cpp` of the firmware for ROS 2 does; speeds are limited to what 77 turns
a minute of its motors give, and are zero unless the heartbeat has changed within 0.5 s.
"""

from __future__ import annotations

import math
import struct

from ur_nodes.simulator.devices.plant import Plant

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

    def take(self, data: bytes) -> bytes:
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
                answer += self._obey(_unstuff(packet[7:-2]))

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
            self._refresh()
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

    def _refresh(self) -> None:
        volts = self._plant.battery()[0]
        scale = 4096 / (2.0 * math.pi * self._plant.base.wheels.radius)
        left, right = (_wrap(int(each * scale) + self._counted) for each in self._plant.rolled())
        self._table[18] = 0 if self.power else 255
        pressed = self._plant.bumpers()
        self._table[28:30] = bytes((pressed.get("front", False), pressed.get("back", False)))
        self._table[42:50] = struct.pack("<II", int(volts * 100), 5000)
        self._table[136:144] = struct.pack("<ii", left, right)

    @staticmethod
    def _status(problem: int, data: bytes) -> bytes:
        body = bytes((0x55, problem)) + data
        stuffed = body.replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")
        packet = b"\xff\xff\xfd\x00\xc8" + struct.pack("<H", len(stuffed) + 2) + stuffed
        return packet + struct.pack("<H", compute_crc(packet))


def _unstuff(body: bytes) -> bytes:
    return body.replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")


def _wrap(count: int) -> int:
    return (count + 0x80000000) % 0x100000000 - 0x80000000
