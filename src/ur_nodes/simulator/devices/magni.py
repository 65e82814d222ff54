"""Magni's motor board, from the register map of Serial_Protocol.md (V3) and its worked examples of checksums.

The units of speeds are those of the first versions of ubiquity_motor (TICS_PER_RADIAN 41.0058 / 2, four of them in a
quarter tic, in 0.1 s), which its change e3b6120 says no encoder changes; the firmware caps them at 80, about 1 m/s.
"""

from __future__ import annotations

import math

from ur_nodes.simulator.devices.plant import Plant

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

    def take(self, data: bytes) -> bytes:
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
        return self._respond(0x30, self._take_counts())

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
        return self._respond(register, self._take_counts() if register == 0x30 else values.get(register, bytes(4)))

    def _take_counts(self) -> bytes:
        total = [int(each * self._scale) for each in self._plant.rolled()]
        steps = [max(-32768, min(32767, now - before)) for now, before in zip(total, self._read, strict=True)]
        self._read = total
        return b"".join(each.to_bytes(2, "big", signed=True) for each in steps)

    @staticmethod
    def _respond(register: int, data: bytes) -> bytes:
        body = bytes((0x3C, register)) + data
        return b"\x7e" + body + bytes((255 - sum(body) % 256,))
