"""Scans compared with what stand-ins measured: python -m tests.ur_nodes.drivers.scans [MINUTES] [NAME ...].

Simulated time. Each beam of a stand-in has a distance that tells its number, so each one of a published scan is
compared with the angle and the time at which it was measured. Bytes take their time on the line, at the speed of the
protocol. Exit code 1 where a beam is off by more than the limits.
"""

import math
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tests.ur_nodes.drivers.mutations import StillPlant

from ur_nodes.drivers.lidar_driver import LidarDriver
from ur_nodes.drivers.lidars.ldrobot import remove_eye, squint
from ur_nodes.drivers.lidars.turning_head import TurningHead
from ur_nodes.drivers.lidars.ydlidar import _correction
from ur_nodes.drivers.lines.line import LineSettings, LineUser
from ur_nodes.drivers.readings import MeasuredBeams, Reading
from ur_nodes.drivers.registry import FIRMWARES, LIDARS
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.node import SECOND
from ur_nodes.ports.values import Scan

_Floats = NDArray[np.float64]
MINUTES = 10.0
TICK = 0.002  # s; a serial line collects bytes for so long
ANGLE, TIME = 0.1, 0.005  # degrees, s
FIRST, STEP, TURNS = 1000.0, 10.0, 8  # mm of beam 0, of one to the next, and turns that differ by a mm each
USB = ("hokuyo",)  # bytes take no time on it
BITS = 10  # of a byte on a serial line
BETWEEN = ("lds02", "ydlidar")
"""Lidars that measure between the steps of a scan: there a beam is at the nearest one, up to half a step away."""
BEGINNING = {"lds01": 1}  # the first beam since the start


class PacedLine:
    """See DeviceLine: bytes of the stand-in arrive at the speed of the line."""

    name = "/dev/test"

    def __init__(self, firmware: TurningHead, user: LineUser, baud: float) -> None:
        self._firmware, self._user, self._baud = firmware, user, baud
        self._sent, self._free = list[tuple[float, bytes]](), 0.0

    def write(self, data: bytes, *, moving: bool = False) -> None:
        assert not moving
        self._send(self._firmware.receive(data), 0.0)

    def close(self) -> None: ...

    def tick(self, now: int) -> None:
        """Have the lidar measure, and give what has arrived to the driver."""
        seconds = now / SECOND
        self._send(self._firmware.tick(), seconds)
        arrived = b""
        while self._sent and self._sent[0][0] <= seconds:
            arrived += self._sent.pop(0)[1]
        if arrived:
            self._user.received(arrived, now)

    def _send(self, data: bytes, now: float) -> None:
        for at in range(len(data)):
            self._free = max(self._free, now) + BITS / self._baud
            self._sent.append((self._free, data[at : at + 1]))


def number(beams: NDArray[np.int64]) -> _Floats:
    """The distances (mm) that tell beams by their numbers since the start."""
    distances: _Floats = np.add(FIRST + STEP * (beams % 360), beams // 360 % TURNS, dtype=np.float64)
    return distances


@dataclass
class LidarRecord:
    """What came of a lidar: `angle` is the largest error (degrees) of a beam before it was put into a scan."""

    begun: float  # s
    rate: float  # 1/s
    clockwise: bool
    scans: list[Scan] = field(default_factory=list)
    angle: float = 0.0


def record(name: str, minutes: float) -> LidarRecord:
    """Run a lidar."""
    bus, plant = Bus(), StillPlant()
    lidar = plant.base.lidar
    assert lidar
    node, client, plant.time = bus.node("lidar_driver"), bus.node("client"), bus.now / SECOND
    firmware: Any = FIRMWARES[name](plant)  # type: ignore[arg-type]
    firmware.measure = number
    seen = LidarRecord(plant.time, lidar.rate, firmware.clockwise)
    client.subscribe(lidar.topic, Scan, seen.scans.append)
    protocol: Any = LIDARS[name]()
    take = protocol.receive

    def compare_beams(data: bytes) -> Iterator[Reading]:
        for reading in take(data):
            if isinstance(reading, MeasuredBeams):
                exact, *_ = find_beams(name, reading.ranges * 1000.0)
                seen.angle = max(seen.angle, find_error(np.degrees(reading.phases), exact))
            yield reading

    protocol.receive = compare_beams
    lines: list[PacedLine] = []

    def connect(user: LineUser, settings: LineSettings) -> PacedLine:
        lines.append(PacedLine(firmware, user, 1e9 if name in USB else settings.baud))
        return lines[-1]

    LidarDriver(node, lidar, protocol, connect, 0.0)
    lines[0]._user.opened()

    def advance() -> None:
        plant.time = bus.now / SECOND
        lines[0].tick(bus.now)

    node.every(TICK, advance)
    bus.run(minutes * 60.0)
    return seen


def compare(name: str, minutes: float) -> tuple[int, int, float, float]:
    """Return the numbers of scans and beams, and the largest error of an angle (degrees) and of a time (s)."""
    seen = record(name, minutes)
    angle, late, count = seen.angle, 0.0, 0
    for scan in seen.scans:
        there = np.flatnonzero(np.isfinite(scan.ranges))
        millimetres = scan.ranges[there].astype(np.float64) * 1000.0
        exact, beam, turn = find_beams(name, millimetres)
        shown = np.degrees(scan.angle_min + there * scan.angle_increment) * (-1.0 if seen.clockwise else 1.0)
        half = math.degrees(scan.angle_increment) / 2.0 if name in BETWEEN else 0.0
        angle = max(angle, find_error(shown, exact) - half)
        stamps = scan.stamp / SECOND + there * scan.time_increment - seen.begun
        turns = stamps * seen.rate - beam / 360.0
        turns = turn + np.rint((turns - turn) / TURNS) * TURNS
        times = (turns + (beam + 1.0 - BEGINNING.get(name, 0)) / 360.0) / seen.rate
        late = max(late, float(np.abs(stamps - times).max()))
        count += len(there)
    return len(seen.scans), count, angle, late


def find_beams(name: str, shown: _Floats) -> tuple[_Floats, _Floats, _Floats]:
    """The angles (degrees, as the head turns), numbers within a turn and turns of beams by their distances (mm)."""
    if name == "lds02":
        measured, turned = remove_eye(shown), -squint(remove_eye(shown))
    else:
        measured, turned = shown, _correction(shown) if name == "ydlidar" else np.zeros_like(shown)
    beam, turn = np.divmod(np.rint(measured) - FIRST, STEP)
    return beam + np.degrees(turned), beam, turn


def find_error(shown: _Floats, exact: _Floats) -> float:
    """The largest difference of angles (degrees)."""
    return float(np.abs((shown - exact + 180.0) % 360.0 - 180.0).max(initial=0.0))


def main() -> int:
    """Compare each lidar, and print the largest errors."""
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else MINUTES
    failed = False
    for name in sys.argv[2:] or LIDARS:
        begun = time.monotonic()
        scans, beams, angle, late = compare(name, minutes)
        failed = failed or angle > ANGLE or late > TIME or scans < minutes * 60.0 * 4.0
        text = f"{scans} scans, {beams} beams, angle within {angle:.3f} degrees, time within {late * 1000.0:.1f} ms"
        sys.stdout.write(f"{name}: {minutes:g} min in {time.monotonic() - begun:.0f} s: {text}\n")
        sys.stdout.flush()
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
