"""iRobot Create 2 and Roomba 500 to 800: "iRobot Create 2 Open Interface (OI) Specification based on the Roomba 600".

The robot sends a frame of sensors every 15 ms: 19, the number of bytes, pairs of a packet's id and its value, and a
checksum that makes the sum of all bytes 0 (the 19 too, which the first Create left out). Its counters have 16 bits,
508.8 counts in a turn of wheels of 72 mm. It has no watchdog of its own: in the modes Safe and Full it drives on with
its last command.
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

START, SAFE, STOP, DRIVE_DIRECT, STREAM, PAUSE_STREAM = 128, 131, 173, 145, 148, 150
FASTEST = 500  # mm/s
_HEADER = 19
_SAFE, _FULL = 2, 3
# Packets of the stream: id, and how its value is packed (big-endian).
_PACKETS = {7: "B", 9: "B", 10: "B", 11: "B", 12: "B", 21: "B", 22: "H", 23: "h", 25: "H", 26: "H", 35: "B",
            43: "H", 44: "H"}  # fmt: skip
_BUMPS, _CHARGING, _VOLTAGE, _CURRENT, _CHARGE, _CAPACITY, _MODE, _LEFT, _RIGHT = 7, 21, 22, 23, 25, 26, 35, 43, 44
_CLIFFS = {9: "left", 10: "front_left", 11: "front_right", 12: "right"}
_LAYOUT = struct.Struct(">" + "".join("B" + kind for kind in _PACKETS.values()))
_SIZE = _LAYOUT.size + 3
_AGAIN = 25  # beats, after which the mode is asked for again where the robot has left it


class Create2:
    """See MotorBoard."""

    name = "iRobot Create 2 or Roomba"
    baud = 115200
    period = 0.04
    counts_per_turn = 508.8

    def __init__(self, base: Base) -> None:  # noqa: ARG002 - its wheels are those of the specification
        self._frames = FrameReader(bytes((_HEADER, _LAYOUT.size)), _measure, _is_valid, _SIZE)
        self._asleep = 0  # beats in a mode that does not drive
        self._driving: bool | None = None
        self._state: tuple[int, ...] = ()  # all but the counters

    @property
    def rejected(self) -> int:
        return self._frames.rejected

    def handshake(self) -> bytes:
        """Start, Safe, and the stream of its sensors."""
        self._driving, self._state = None, ()
        return bytes((START, SAFE, STREAM, len(_PACKETS), *_PACKETS))

    def drive(self, left: float, right: float) -> bytes:
        """See MotorBoard. The mode Safe ends by itself at a cliff and on the charger: it is asked for again."""
        self._asleep += self._driving is False
        wake = bytes((SAFE,)) if self._driving is False and self._asleep % _AGAIN == 0 else b""
        speeds = (clip(each * 1000.0, FASTEST) for each in (right, left))
        return wake + struct.pack(">Bhh", DRIVE_DIRECT, *speeds)

    def stop(self) -> bytes:
        """See MotorBoard. Zeros first: they end a command that was cut off."""
        return bytes(4) + struct.pack(">Bhh", DRIVE_DIRECT, 0, 0)

    def shutdown(self) -> bytes:
        """Pause the stream and stop the interface: its buttons work again."""
        return bytes((PAUSE_STREAM, 0, STOP))

    def receive(self, data: bytes) -> Iterator[Reading]:
        for frame in self._frames.receive(data):
            yield from self._read(frame)

    def _read(self, frame: bytes) -> Iterator[Reading]:
        cells = _LAYOUT.unpack_from(frame, 2)
        value = dict(zip(cells[::2], cells[1::2], strict=True))
        yield Counts(value[_LEFT], value[_RIGHT], 16)
        state = cells[1:-4:2]
        if state == self._state:
            return
        self._state = state
        if self._driving is None:
            yield DeviceIdentity("streams its sensors")
        lifted = bool(value[_BUMPS] & 0b1100)
        self._driving = value[_MODE] in (_SAFE, _FULL)
        why = "a wheel hangs in the air" if lifted else "it is on its charger, at a cliff, or its button was pressed"
        yield Motors(True) if self._driving and not lifted else Motors(False, why)
        yield Contacts("bumper", (("left", bool(value[_BUMPS] & 2)), ("right", bool(value[_BUMPS] & 1))))
        yield Contacts("cliff", tuple((name, bool(value[packet])) for packet, name in _CLIFFS.items()))
        volts, amperes, charge, capacity = (value[each] / 1000.0 for each in (_VOLTAGE, _CURRENT, _CHARGE, _CAPACITY))
        yield Power(volts, amperes, charge, capacity, value[_CHARGING] in (1, 2, 3))


def _measure(frame: bytes) -> int:
    return _SIZE if len(frame) >= 2 else MORE


def check(frame: bytes) -> bool:
    """The sum of a whole frame of the stream is 0."""
    return sum(frame) & 0xFF == 0


def _is_valid(frame: bytes) -> bool:
    return check(frame) and tuple(_LAYOUT.unpack_from(frame, 2)[::2]) == tuple(_PACKETS)


# Stand-in: an iRobot Create 2, from the tables of commands and sensor packets of its Open Interface specification
# (2018).

COUNTS_PER_METRE = 508.8 / (math.pi * 0.072)
STREAM_PERIOD = 0.015  # s
# Opcodes and the number of their data bytes; those of variable length are read apart.
_DATA_BYTES = {7: 0, 128: 0, 129: 1, 130: 0, 131: 0, 132: 0, 133: 0, 134: 0, 135: 0, 136: 1, 137: 4, 138: 1, 139: 3,
               141: 1, 142: 1, 143: 0, 144: 3, 145: 4, 146: 4, 147: 1, 150: 1, 162: 2, 163: 4, 164: 4, 165: 1,
               168: 3, 173: 0}  # fmt: skip
OFF, PASSIVE, SAFE_MODE, FULL = 0, 1, 2, 3


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

    def receive(self, data: bytes) -> bytes:
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
        if self.mode == SAFE_MODE and (self.lifted or any(self._plant.cliffs().values())):
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
            self.mode = SAFE_MODE if not self.lifted else PASSIVE
        elif code == 132:
            self.mode = FULL
        elif code == 145 and self.mode in (SAFE_MODE, FULL):
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
