"""iRobot Create 2 and Roomba 500 to 800: "iRobot Create 2 Open Interface (OI) Specification based on the Roomba 600".

The robot sends a frame of sensors every 15 ms: 19, the number of bytes, pairs of a packet's id and its value, and a
checksum that makes the sum of all bytes 0 (the 19 too, which the first Create left out). Its counters have 16 bits,
508.8 counts in a turn of wheels of 72 mm. It has no watchdog of its own: in the modes Safe and Full it drives on with
its last command.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

from ur.robot.base import Base
from ur_nodes.drivers.boards.board import clip
from ur_nodes.drivers.frames import MORE, FrameReader
from ur_nodes.drivers.readings import Contacts, Counts, DeviceIdentity, Motors, Power, Reading

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

    def greet(self) -> bytes:
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

    def leave(self) -> bytes:
        """Pause the stream and stop the interface: its buttons work again."""
        return bytes((PAUSE_STREAM, 0, STOP))

    def take(self, data: bytes) -> Iterator[Reading]:
        for frame in self._frames.take(data):
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
