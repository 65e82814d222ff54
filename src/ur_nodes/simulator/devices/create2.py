"""An iRobot Create 2, from the tables of commands and sensor packets of its Open Interface specification (2018)."""

from __future__ import annotations

import math
import struct

from ur_nodes.simulator.devices.plant import Plant

COUNTS_PER_METRE = 508.8 / (math.pi * 0.072)
STREAM_PERIOD = 0.015  # s
# Opcodes and the number of their data bytes; those of variable length are read apart.
_DATA_BYTES = {7: 0, 128: 0, 129: 1, 130: 0, 131: 0, 132: 0, 133: 0, 134: 0, 135: 0, 136: 1, 137: 4, 138: 1, 139: 3,
               141: 1, 142: 1, 143: 0, 144: 3, 145: 4, 146: 4, 147: 1, 150: 1, 162: 2, 163: 4, 164: 4, 165: 1,
               168: 3, 173: 0}  # fmt: skip
OFF, PASSIVE, SAFE, FULL = 0, 1, 2, 3


class Create2Firmware:
    """See Firmware. `lifted`: a wheel hangs in the air, which ends the mode Safe; `counted` begins its counters."""

    covers = frozenset(("battery", "bumpers", "cliffs"))

    def __init__(self, plant: Plant, *, counted: int = 0) -> None:
        self._plant, self._counted = plant, counted
        self._bytes = bytearray()
        self._packets: list[int] = []
        self._streams = False
        self._due = plant.time
        self.mode = OFF
        self.lifted = False

    def take(self, data: bytes) -> bytes:
        self._bytes += data
        answer = b""
        while self._bytes:
            code = self._bytes[0]
            if code in (148, 149, 140):
                head = 3 if code == 140 else 2
                if len(self._bytes) < head:
                    break
                size = head + self._bytes[head - 1] * (2 if code == 140 else 1)
            else:
                size = 1 + _DATA_BYTES.get(code, 0)
            if len(self._bytes) < size:
                break
            answer += self._obey(code, bytes(self._bytes[1:size]))
            del self._bytes[:size]
        return answer

    def tick(self) -> bytes:
        if self.mode == SAFE and (self.lifted or any(self._plant.cliffs().values())):
            self.mode = PASSIVE
            self._plant.turn_wheels(0.0, 0.0)
        sent = b""
        while self._plant.time >= self._due:
            self._due += STREAM_PERIOD
            if self._streams and self.mode != OFF:
                body = b"".join(bytes((each,)) + self._packet(each) for each in self._packets)
                frame = bytes((19, len(body))) + body
                sent += frame + bytes((-sum(frame) & 0xFF,))
        return sent

    def _obey(self, code: int, data: bytes) -> bytes:
        if code == 128:
            self.mode = PASSIVE
        elif code == 173:
            self._plant.turn_wheels(0.0, 0.0)
            self.mode, self._streams = OFF, False
        elif self.mode == OFF:
            pass
        elif code in (130, 131):
            self.mode = SAFE if not self.lifted else PASSIVE
        elif code == 132:
            self.mode = FULL
        elif code == 145 and self.mode in (SAFE, FULL):
            right, left = struct.unpack(">hh", data)
            self._plant.turn_wheels(*(max(-500, min(500, each)) / 1000.0 for each in (left, right)))
        elif code == 148:
            self._packets, self._streams = list(data[1:]), True
        elif code == 150:
            self._streams = bool(data[0])
        elif code == 142:
            return self._packet(data[0])
        return b""

    def _packet(self, number: int) -> bytes:
        if number == 7:
            pressed = self._plant.bumpers()
            return bytes((pressed.get("right", False) | pressed.get("left", False) << 1 | (12 if self.lifted else 0),))
        cliffs = {9: "left", 10: "front_left", 11: "front_right", 12: "right"}
        if number in cliffs:
            return bytes((self._plant.cliffs().get(cliffs[number], False),))
        voltage, current, charge, capacity = self._plant.battery()
        power = {22: (">H", voltage), 23: (">h", current), 25: (">H", charge), 26: (">H", capacity)}
        if number in power:
            layout, value = power[number]
            return struct.pack(layout, int(value * 1000))
        if number in (43, 44):
            rolled = self._plant.rolled()[number - 43]
            return struct.pack(">H", (int(rolled * COUNTS_PER_METRE) + self._counted) & 0xFFFF)
        return bytes((self.mode if number == 35 else 0,))
