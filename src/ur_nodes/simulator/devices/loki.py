"""Loki's board, from the comments on the line protocol in bus_server.py (indigo-devel) and from its Sonar.cpp.

The order of work in the firmware is that of the source: a command is read up to its carriage return, with all arguments
that were sent before it; the controllers turn the wheels by so many ticks in 20 ms, at most what its gear motors can.
"""

from __future__ import annotations

import math

from ur_nodes.simulator.devices.plant import Plant

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

    def take(self, data: bytes) -> bytes:
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
            return "{} {}".format(*self._count())
        if self._letter == "m":
            self._turn(*self._kept)
            return "OK"
        if self._letter == "q":
            return self._report()
        if self._letter == "u" and len(self._arguments) == 5:
            self.gains = tuple(self._arguments)
            return "OK\r\nOK"
        return {"r": "OK", "v": "OK", "s": "Bad s command"}.get(self._letter, "Invalid Command!")

    def _count(self) -> list[int]:
        counts = [int(each * self._ticks) + self._counted for each in self._plant.rolled()]
        return [(each + (1 << 31)) % (1 << 32) - (1 << 31) for each in counts]

    def _turn(self, left: int, right: int) -> None:
        speeds = [max(-FASTEST, min(FASTEST, each * 50.0 / self._ticks)) for each in (left, right)]
        self._plant.turn_wheels(*speeds)

    def _report(self) -> str:
        now = self._plant.time
        parts = [str(round((now - self._asked) * 1e6))]
        self._asked = now
        parts += [f"{number + 2}:{round((at - now) * 1e6)}:{mm}" for number, (at, mm) in sorted(self._news.items())]
        self._news.clear()
        return " ".join(parts)
