"""A plain robot with two wheels and an Arduino: the line protocol of n_base_driver/arduino/ur_base/ur_base.ino.

Lines of ASCII that end with a newline. `*` and two hexadecimal digits, the exclusive or of all bytes before the `*`,
end each of them, as in NMEA 0183.

    v LEFT RIGHT*XX                     to the board: counts a second; the motors stop 150 ms after the last one
    ?*XX                                to the board: who are you
    h ur-base 1 TEXT*XX                 from the board: version of the protocol, and a text about itself
    e LEFT RIGHT MILLIVOLT FLAGS*XX     from the board, 50 times a second: counters of 32 bits, the battery (0: none)

FLAGS is a sum: 1 the motors have no power (emergency stop), 2 bumper `left`, 4 bumper `right`, 8 bumper `front`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import reduce
from operator import xor
from typing import TYPE_CHECKING

from ur.robot.base import Base
from ur.source.foreign.numbers import parse_integer
from ur_nodes.drivers.boards.board import clip, scale_of
from ur_nodes.drivers.readings import Contacts, Counts, DeviceIdentity, Motors, Power, Reading

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.plant import Plant

LONGEST = 120  # bytes of a line
_FASTEST = 1_000_000  # counts a second
_NO_POWER, _BUMPERS = 1, ((2, "left"), (4, "right"), (8, "front"))


class Arduino:
    """See MotorBoard."""

    name = "Arduino with the sketch ur_base"
    baud = 115200
    period = 0.04

    def __init__(self, base: Base) -> None:
        self._scale = scale_of(base)
        self.counts_per_turn = self._scale.counts_per_turn
        self._buffer = b""
        self.rejected = 0

    def handshake(self) -> bytes:
        """Ask for its name."""
        return make_line("?")

    def drive(self, left: float, right: float) -> bytes:
        speeds = (clip(each * self._scale.counts_per_metre, _FASTEST) for each in (left, right))
        return make_line("v {} {}".format(*speeds))

    def stop(self) -> bytes:
        """See MotorBoard. The empty line ends one that was cut off."""
        return b"\n" + make_line("v 0 0")

    def shutdown(self) -> bytes:
        """Nothing: it is left as it was found."""
        return b""

    def receive(self, data: bytes) -> Iterator[Reading]:
        *lines, self._buffer = (self._buffer + data).split(b"\n")
        self._buffer = self._buffer[-LONGEST:]
        for line in lines:
            readings = list(_read(line.strip()))
            self.rejected += bool(line.strip()) and not readings
            yield from readings


def make_line(text: str) -> bytes:
    """A line with its checksum."""
    return f"{text}*{reduce(xor, text.encode(), 0):02X}\n".encode()


def _read(line: bytes) -> Iterator[Reading]:
    body, star, checksum = line.rpartition(b"*")
    if not star or len(line) > LONGEST or checksum.upper() != b"%02X" % reduce(xor, body, 0):
        return
    kind, *words = body.decode("ascii", "replace").split() or [""]
    if kind == "h" and words[:1] == ["ur-base"]:
        version = words[1] if len(words) > 1 else "?"
        problem = "" if version == "1" else f"protocol {version}, expected 1: flash the sketch of this release"
        yield DeviceIdentity(" ".join(words[2:]) or "ur_base", problem)
    elif kind == "e" and len(words) == 4:
        left, right, millivolt, flags = (parse_integer(word) for word in words)
        if left is None or right is None or millivolt is None or flags is None:
            return
        yield Counts(left, right)
        yield Motors(not flags & _NO_POWER, "its motors have no power (emergency stop?)" if flags & _NO_POWER else "")
        yield Contacts("bumper", tuple((name, bool(flags & bit)) for bit, name in _BUMPERS))
        if millivolt > 0:
            yield Power(millivolt / 1000.0)


# Stand-in: a board with the sketch ur_base, as the comment at the head of that sketch describes its lines.

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

    def receive(self, data: bytes) -> bytes:
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
