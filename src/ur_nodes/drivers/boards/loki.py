"""Ubiquity Robotics' Loki: the text commands of its firmware, `bus_server` on an ATmega2560.

Sources: bus_server.py and bus_server.cpp of loki_base_node; Sonar.cpp of bus_loki and bus_common. Commands are a letter
and whole numbers, and end with a carriage return; each answer is a line. No line has a checksum.

    b                      115200                      who are you
    u KP KD KI KO CI       OK                          the gains of the wheels' controllers
    m LEFT RIGHT           OK                          counts that the wheels shall make in 20 ms
    e                      LEFT RIGHT                  counters of 32 bits
    q                      MICROSECONDS ID:TIME:VALUE ...
                           the time since the last `q`, and what is new: 0 and 1 the wheels, from 2 on the sonars, when
                           (microseconds, 0 is now) and how far (mm)

The firmware has no watchdog: the motors turn until the next `m`. It keeps 15 bytes while it writes.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ur.robot.base import Base
from ur_nodes.drivers.boards.board import clip, scale_of
from ur_nodes.drivers.readings import Counts, DeviceIdentity, Reading, SonarEcho

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.plant import Plant

LONGEST = 500  # bytes of a line: 18 values of 25 bytes
FRAMES = 50.0  # of the controllers, a second
GAINS = b"u 30 7 25 600 400\r"  # param/loki.yaml of loki_robot; the firmware begins with less of the last
_FIRST_SONAR = 2
_SONARS_EVERY, _GAINS_EVERY = 3, 250  # beats
_OLDEST = 1.0  # s, of the distance of a sonar
_SLACK = 2.0  # times the fastest speed of a rim
_COUNTS = re.compile(rb"(-?\d{1,10}) (-?\d{1,10})")
_QUEUE = re.compile(rb"(\d{1,10})((?: \d{1,2}:-?\d{1,10}:-?\d{1,10})*)")
_OK = (b"", b"OK", b"Invalid Command!")  # the last one answers a return that ends nothing


class Loki:
    """See MotorBoard."""

    name = "Loki's board"
    baud = 115200
    period = 0.04

    def __init__(self, base: Base) -> None:
        self._scale = scale_of(base)
        self.counts_per_turn = self._scale.counts_per_turn
        rim = base.limits.velocity + base.limits.angular_velocity * base.wheels.separation / 2.0
        self._most = _SLACK * rim * self._scale.counts_per_metre * self.period  # counts in a beat
        self._buffer = b""
        self._beats = self._believed = 0
        self._last: tuple[int, int] | None = None
        self._doubted: tuple[int, int] | None = None
        self._time = 0  # microseconds of its clock, summed up
        self._echoed: dict[int, int] = {}
        self.rejected = 0

    def handshake(self) -> bytes:
        """End a command that was cut off, and ask who it is."""
        return b"\rb\r" + GAINS

    def drive(self, left: float, right: float) -> bytes:
        """See MotorBoard. The question with the longest answer comes last."""
        self._beats += 1
        data = self._speeds(left, right) + b"e\r"
        if self._beats % _GAINS_EVERY == 0:
            return data + GAINS
        return data + (b"q\r" if self._beats % _SONARS_EVERY == 0 else b"")

    def _speeds(self, left: float, right: float) -> bytes:
        counts = tuple(clip(each * self._scale.counts_per_metre / FRAMES, 9999) for each in (left, right))
        return b"m %d %d\r" % counts

    def stop(self) -> bytes:
        """See MotorBoard. The return before it ends a command that was cut off."""
        return b"\r" + self._speeds(0.0, 0.0)

    def shutdown(self) -> bytes:
        """Nothing: it is left as it was found."""
        return b""

    def receive(self, data: bytes) -> Iterator[Reading]:
        *lines, self._buffer = (self._buffer + data).split(b"\n")
        self._buffer = self._buffer[-LONGEST:]
        for line in lines:
            yield from self._read(line.strip())

    def _read(self, line: bytes) -> Iterator[Reading]:
        if line == b"115200":
            yield DeviceIdentity("firmware bus_server")
        elif counts := _COUNTS.fullmatch(line):
            yield from self._on_counts((int(counts[1]), int(counts[2])))
        elif len(line) <= LONGEST and (queue := _QUEUE.fullmatch(line)):
            yield from self._on_queue(int(queue[1]), queue[2].split())
        elif line not in _OK:
            self.rejected += 1

    def _on_counts(self, counts: tuple[int, int]) -> Iterator[Reading]:
        """Believe what the wheels can have turned since the last one, or twice in a row: nothing else checks a line."""
        near = self._last is None or self._is_near(counts, self._last)
        if not near and (self._doubted is None or not self._is_near(counts, self._doubted)):
            self._doubted = counts
            self.rejected += 1
            return
        self._last, self._doubted, self._believed = counts, None, self._beats
        yield Counts(*counts)

    def _is_near(self, counts: tuple[int, int], others: tuple[int, int]) -> bool:
        most = self._most * (2 + self._beats - self._believed)
        return all(abs(each - other) <= most for each, other in zip(counts, others, strict=True))

    def _on_queue(self, passed: int, values: list[bytes]) -> Iterator[Reading]:
        """The firmware reports the distance of a sonar's echo before the one that it reports the time of."""
        self._time += passed
        for value in values:
            sonar, ago, millimetres = map(int, value.split(b":"))
            number = sonar - _FIRST_SONAR
            if number < 0:
                continue
            before, self._echoed[number] = self._echoed.get(number), self._time + ago
            age = (self._time - (before or 0)) / 1e6
            if before is not None and millimetres >= 0 and 0.0 <= age <= _OLDEST:
                yield SonarEcho(number, millimetres / 1000.0, age)


# Stand-in: Loki's board, from the comments on the line protocol in bus_server.py (indigo-devel) and from its Sonar.cpp.
# The order of work in the firmware is that of the source: a command is read up to its carriage return, with all
# arguments that were sent before it; the controllers turn the wheels by so many ticks in 20 ms, at most what its gear
# motors can.

FASTEST = 0.314  # m/s: 100 turns a minute of a wheel of 60 mm
SOUNDS = 0.0125  # s between two sonars
OUT_OF_REACH = 6460  # mm: an HC-SR04 ends the pulse of a lost echo after 38 ms
_LETTERS = "abcdefghijklmnopqrstuvwxyz"


class LokiFirmware:
    """See Firmware. Its sonars report with the time of an echo the distance of the one before."""

    covers = frozenset(("battery", "sonars"))

    def __init__(self, plant: Plant, *, counted: int = 0) -> None:
        """`counted` is what its counters begin with."""
        self._plant, self._counted = plant, counted
        self._ticks = plant.base.odometry.ticks_per_turn / (2.0 * math.pi * plant.base.wheels.radius)
        self._letter, self._number, self._digits, self._minus = "", 0, False, False
        self._arguments: list[int] = []
        self._kept = [0, 0]  # arguments stay in their places from command to command
        self._asked = self._sounded = plant.time
        self._sonar = 0
        self._millimetres: dict[int, int] = {}
        self._news: dict[int, tuple[float, int]] = {}
        self.gains: tuple[int, ...] = (30, 7, 25, 600, 100)

    def receive(self, data: bytes) -> bytes:
        return b"".join(self._receive(chr(byte)) for byte in data)

    def tick(self) -> bytes:
        """See Firmware: it sends nothing by itself."""
        while self._plant.time - self._sounded >= SOUNDS:
            self._sounded += SOUNDS
            self._listen()
        return b""

    def _listen(self) -> None:
        ranges = self._plant.sonars()
        if not ranges:
            return
        number = self._sonar = (self._sonar + 1) % len(ranges)
        self._news[number] = (self._sounded, self._millimetres.get(number, 0))
        self._millimetres[number] = round(max(0.0, min(OUT_OF_REACH, ranges[number] * 1000.0)))

    def _receive(self, character: str) -> bytes:
        if character == "-":
            self._minus = True
        elif "0" <= character <= "9":
            self._number = (self._number * 10 + int(character)) & 0x7FFFFFFF
            self._digits = True
        elif character in " :\r" and self._digits:
            self._arguments.append(-self._number if self._minus else self._number)
            self._number, self._digits, self._minus = 0, False, False
        elif character in _LETTERS:
            self._letter = character
        if character != "\r":
            return b""
        self._kept[: len(self._arguments[:2])] = self._arguments[:2]
        answer = self._obey()
        self._letter, self._arguments = "?", []
        return answer.encode() + b"\r\n"

    def _obey(self) -> str:
        if self._letter == "b":
            return "115200"
        if self._letter == "e":
            counts = [int(each * self._ticks) + self._counted for each in self._plant.rolled()]
            return "{} {}".format(*[(each + (1 << 31)) % (1 << 32) - (1 << 31) for each in counts])
        if self._letter == "m":
            self._turn(*self._kept)
            return "OK"
        if self._letter == "q":
            now = self._plant.time
            parts = [str(round((now - self._asked) * 1e6))]
            self._asked = now
            parts += [f"{number + 2}:{round((at - now) * 1e6)}:{mm}" for number, (at, mm) in sorted(self._news.items())]
            self._news.clear()
            return " ".join(parts)
        if self._letter == "u" and len(self._arguments) == 5:
            self.gains = tuple(self._arguments)
            return "OK\r\nOK"
        return {"r": "OK", "v": "OK", "s": "Bad s command"}.get(self._letter, "Invalid Command!")

    def _turn(self, left: int, right: int) -> None:
        speeds = [max(-FASTEST, min(FASTEST, each * 50.0 / self._ticks)) for each in (left, right)]
        self._plant.turn_wheels(*speeds)
