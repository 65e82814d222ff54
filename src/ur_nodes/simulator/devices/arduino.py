"""A board with the sketch ur_base, as the comment at the head of that sketch describes its lines."""

from __future__ import annotations

import math

from ur_nodes.simulator.devices.plant import Plant

WATCHDOG = 0.15  # s
PERIOD = 0.02  # s
_BITS = {"left": 2, "right": 4, "front": 8}


class ArduinoFirmware:
    """See Firmware. `power`: the motors have power; `reset` begins its counters anew."""

    covers = frozenset(("battery", "bumpers"))

    def __init__(self, plant: Plant, *, counted: int = 0) -> None:
        """`counted` is what its counters begin with."""
        self._plant = plant
        self._scale = plant.base.odometry.ticks_per_turn / (2.0 * math.pi * plant.base.wheels.radius)
        self._counted = counted
        self._line = b""
        self._commanded = -1.0
        self._sent = plant.time
        self.power = True

    def take(self, data: bytes) -> bytes:
        answer = b""
        self._line += data
        while b"\n" in self._line:
            line, _, self._line = self._line.partition(b"\n")
            answer += self._obey(line.strip())
        self._line = self._line[-200:]
        return answer

    def tick(self) -> bytes:
        now = self._plant.time
        if self._commanded >= 0.0 and (now - self._commanded > WATCHDOG or not self.power):
            self._plant.turn_wheels(0.0, 0.0)
            self._commanded = -1.0
        if now - self._sent < PERIOD - 1e-6:
            return b""
        self._sent = now
        left, right = (self._wrap(int(each * self._scale) + self._counted) for each in self._plant.rolled())
        flags = (not self.power) + sum(_BITS.get(name, 0) for name, on in self._plant.bumpers().items() if on)
        return self._send(f"e {left} {right} {int(self._plant.battery()[0] * 1000)} {flags}")

    def _obey(self, line: bytes) -> bytes:
        text, star, given = line.rpartition(b"*")
        if not star or given != _checksum(text):
            return b""
        if text == b"?":
            return self._send("h ur-base 1 stand-in")
        words = text.split()
        if len(words) == 3 and words[0] == b"v" and self.power:
            try:
                left, right = int(words[1]), int(words[2])
            except ValueError:
                return b""
            self._commanded = self._plant.time
            self._plant.turn_wheels(left / self._scale, right / self._scale)
        return b""

    @staticmethod
    def _send(text: str) -> bytes:
        return text.encode() + b"*" + _checksum(text.encode()) + b"\r\n"

    @staticmethod
    def _wrap(count: int) -> int:
        return (count + 0x80000000) % 0x100000000 - 0x80000000


def _checksum(text: bytes) -> bytes:
    total = 0
    for byte in text:
        total ^= byte
    return b"%02X" % total
