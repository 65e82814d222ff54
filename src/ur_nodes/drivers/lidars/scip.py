"""Hokuyo URG and UTM: "Communication Protocol Specification for SCIP 2.0 Standard", with distances of 3 characters.

A request is a line. An answer is a block of lines that an empty one ends: the request, a status and its sum, and lines
that end with a sum: the low 6 bits of the sum of their bytes, and 30 hexadecimal. `PP` gives the parameters of a model
(resolution, first, last and front step, range, turns a minute); `MD` asks for scans without end, each a block with the
status 99, a time and distances in mm, 6 bits in a character. Steps turn counter-clockwise. Small distances are errors.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from numpy.typing import NDArray

from ur.source.foreign.numbers import parse_integer
from ur_nodes.drivers.lidars.turning_head import TurningHead
from ur_nodes.drivers.readings import DeviceIdentity, MeasuredBeams, Reading, Reply

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.plant import Plant

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

    def handshake(self) -> bytes:
        """End what it does, and ask for its version and parameters."""
        self._model = {}
        return b"\nSCIP2.0\nQT\nVV\nPP\n"

    def shutdown(self) -> bytes:
        """Switch the laser off."""
        return b"\nQT\n"

    def receive(self, data: bytes) -> Iterator[Reading]:
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
            yield from self._on_model(_read_pairs(rows))
        elif request[:2] == b"MD" and status[:2] == b"99" and self._model:
            yield from self._read_scan(rows)
        elif request[:2] == b"MD" and status[:2] not in (b"00", b"99"):
            code = status[:2].decode("ascii", "replace")
            yield DeviceIdentity("", f"it refuses to measure (status {code}); switch it off and on again")

    def _on_model(self, texts: Mapping[str, str]) -> Iterator[Reading]:
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


# Stand-in: a Hokuyo lidar, by the wiki pages of the URG network on the commands of SCIP and the answers of a Classic-
# URG. It sees all round, with a step a degree, and gives as its parameters what the base file says of the lidar.

STEPS = 360
FRONT = 180


class ScipFirmware(TurningHead):
    """See Firmware."""

    clockwise = False

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self._line = ""
        self._scan = ""
        self._distances: list[float] = []

    def receive(self, data: bytes) -> bytes:
        *lines, self._line = (self._line + data.decode("latin-1")).split("\n")
        self._line = self._line[-40:]
        return b"".join(self._obey(line) for line in lines if line)

    def pack(self, beams: npt.NDArray[np.int64], millimetres: npt.NDArray[np.float64]) -> bytes:
        """See TurningHead: a block at the end of each turn."""
        sent = b""
        for beam, distance in zip(beams.tolist(), millimetres.tolist(), strict=True):
            step = (beam + FRONT) % STEPS
            if step == 0:
                self._distances = []
            self._distances.append(distance)
            if step == STEPS - 1 and len(self._distances) == STEPS and self._scan:
                clock = int(self._plant.time * 1000.0) % (1 << 24)
                characters = "".join(_encode(min(round(each), 65535), 3) for each in self._distances)
                rows = [_encode(clock, 4), *(characters[at : at + 64] for at in range(0, len(characters), 64))]
                body = "".join(f"{row}{_sum(row)}\n" for row in rows)
                sent += f"{self._scan}\n99b\n{body}\n".encode("latin-1")
        return sent

    def _obey(self, line: str) -> bytes:
        lidar = self._lidar
        if line == "VV":
            rows = ["VEND:Hokuyo Automatic Co.,Ltd.", "PROD:stand-in", "FIRM:1.0", "PROT:SCIP 2.0", "SERI:H1"]
        elif line == "PP":
            near, far = round(lidar.range_min * 1000), round(lidar.range_max * 1000)
            rows = ["MODL:stand-in", f"DMIN:{near}", f"DMAX:{far}", f"ARES:{STEPS}", "AMIN:0", f"AMAX:{STEPS - 1}",
                    f"AFRT:{FRONT}", f"SCAN:{round(lidar.rate * 60)}"]  # fmt: skip
        elif line.startswith("MD"):
            if line[2:10] != f"0000{STEPS - 1:04d}":
                return f"{line}\n05U\n\n".encode("latin-1")
            self._scan, self._distances = line, []
            return f"{line}\n00P\n\n".encode("latin-1")
        elif line in ("QT", "SCIP2.0"):
            self._scan = "" if line == "QT" else self._scan
            return f"{line}\n00P\n\n".encode("latin-1")
        else:
            return f"{line}\n0Ee\n\n".encode("latin-1")
        return f"{line}\n00P\n{''.join(f'{row};{_sum(row)}{chr(10)}' for row in rows)}\n".encode("latin-1")


def _encode(value: int, characters: int) -> str:
    return "".join(chr((value >> 6 * place) % 64 + 48) for place in reversed(range(characters)))


def _sum(text: str) -> str:
    return chr(sum(map(ord, text)) % 64 + 48)
