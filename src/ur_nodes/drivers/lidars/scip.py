"""Hokuyo URG and UTM: "Communication Protocol Specification for SCIP 2.0 Standard", with distances of 3 characters.

A request is a line. An answer is a block of lines that an empty one ends: the request, a status and its sum, and lines
that end with a sum: the low 6 bits of the sum of their bytes, and 30 hexadecimal. `PP` gives the parameters of a model
(resolution, first, last and front step, range, turns a minute); `MD` asks for scans without end, each a block with the
status 99, a time and distances in mm, 6 bits in a character. Steps turn counter-clockwise. Small distances are errors.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from ur.source.foreign.numbers import parse_integer
from ur_nodes.drivers.readings import DeviceIdentity, MeasuredBeams, Reading, Reply

_MOST = 16384  # bytes of a block: a scan of 1,081 steps has 3,400
_STEPS = 10_000
_WANTED = ("ARES", "AMIN", "AMAX", "AFRT", "SCAN", "DMIN", "DMAX")


class Scip:
    """See LidarProtocol. The scan is asked for once the parameters have arrived."""

    name = "Hokuyo URG or UTM"
    baud = 115200
    dtr = True

    def __init__(self) -> None:
        self._buffer = b""
        self._model: Mapping[str, int] = {}
        self.rejected = 0

    def greet(self) -> bytes:
        """End what it does, and ask for its version and parameters."""
        self._model = {}
        return b"\nSCIP2.0\nQT\nVV\nPP\n"

    def leave(self) -> bytes:
        """Switch the laser off."""
        return b"\nQT\n"

    def take(self, data: bytes) -> Iterator[Reading]:
        *blocks, self._buffer = (self._buffer + data).replace(b"\r\n", b"\n").split(b"\n\n")
        self._buffer = self._buffer[-_MOST:]
        for block in blocks:
            lines = block.strip(b"\n").split(b"\n")
            if len(lines) >= 2 and len(block) <= _MOST:
                yield from self._read(lines[0], lines[1], lines[2:])

    def _read(self, request: bytes, status: bytes, rows: list[bytes]) -> Iterator[Reading]:
        if request == b"VV" and status[:2] == b"00":
            texts = _read_pairs(rows)
            yield DeviceIdentity(f"{texts.get('PROD', 'of no known model')}, firmware {texts.get('FIRM', 'unknown')}")
        elif request == b"PP" and status[:2] == b"00":
            yield from self._take_model(_read_pairs(rows))
        elif request[:2] == b"MD" and status[:2] == b"99" and self._model:
            yield from self._read_scan(rows)
        elif request[:2] == b"MD" and status[:2] not in (b"00", b"99"):
            code = status[:2].decode("ascii", "replace")
            yield DeviceIdentity("", f"it refuses to measure (status {code}); switch it off and on again")

    def _take_model(self, texts: Mapping[str, str]) -> Iterator[Reading]:
        numbers = {key: value for key in _WANTED if (value := parse_integer(texts.get(key, ""))) is not None}
        sound = len(numbers) == len(_WANTED) and 0 <= numbers["AMIN"] < numbers["AMAX"] < _STEPS
        if not sound or not 0 < numbers["ARES"] <= _STEPS or numbers["AMAX"] - numbers["AMIN"] >= numbers["ARES"]:
            self.rejected += 1
            return
        self._model = numbers
        yield Reply("MD{:04d}{:04d}00000\n".format(numbers["AMIN"], numbers["AMAX"]).encode())

    def _read_scan(self, rows: list[bytes]) -> Iterator[Reading]:
        model = self._model
        count = model["AMAX"] - model["AMIN"] + 1
        body = b"".join(row[:-1] for row in rows[1:])
        damaged = np.array([each for row in rows[1:] for each in [not _is_right(row)] * len(row[:-1])])
        self.rejected += len(body) != 3 * count or bool(damaged.any())
        if len(body) != 3 * count:
            return
        millimetres = decode(body)
        steps = model["AMIN"] + np.arange(count) - model["AFRT"]
        inside = (millimetres >= model["DMIN"]) & (millimetres <= model["DMAX"])
        ranges = np.where(inside, millimetres / 1000.0, np.inf)
        ranges[damaged.reshape(-1, 3).any(axis=1)] = np.nan
        phases: NDArray[np.float64] = np.mod(steps * (2.0 * math.pi / model["ARES"]), 2.0 * math.pi)
        turn_time = 60.0 / model["SCAN"] if model["SCAN"] > 0 else 0.0
        yield MeasuredBeams(phases, ranges, np.zeros(0), turn_time=turn_time)


def decode(body: bytes) -> NDArray[np.int64]:
    """The distances (n,) of 3 n characters."""
    parts = (np.frombuffer(body, np.uint8).astype(np.int64) - 0x30) & 0x3F
    distances: NDArray[np.int64] = parts.reshape(-1, 3) @ np.array((4096, 64, 1))
    return distances


def check(row: bytes) -> int:
    """The sum of a line, a character."""
    return (sum(row) & 0x3F) + 0x30


def _is_right(row: bytes) -> bool:
    return bool(row) and check(row[:-1]) == row[-1]


def _read_pairs(rows: list[bytes]) -> dict[str, str]:
    """The values of lines as `AMIN:44;7`, whose sum counts without the semicolon."""
    pairs = {}
    for row in rows:
        body, semicolon, end = row.rpartition(b";")
        if semicolon and len(end) == 1 and check(body) == end[0]:
            key, _, value = body.decode("ascii", "replace").partition(":")
            pairs[key] = value.strip()
    return pairs
