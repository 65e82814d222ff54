"""Frames that drivers lose in a long time: python -m tests.ur_nodes.drivers.endurance [MINUTES] [NAME ...].

Simulated time, faster than real: each driver runs on a bus behind its stand-in, whose bytes arrive in pieces of any
size. Every frame that the stand-in sent has to be understood, none may be rejected, and the counts at the end are those
of the wheels.
"""

import random
import sys
import time
from collections.abc import Iterator
from typing import Any

from tests.base_contract import load
from tests.ur_nodes.drivers.mutations import StillPlant
from tests.ur_nodes.drivers.rig import Cable, MemoryLine

from ur_nodes.drivers.base_driver import BaseDriver
from ur_nodes.drivers.lidar_driver import LidarDriver
from ur_nodes.drivers.readings import Counts, MeasuredBeams
from ur_nodes.drivers.registry import BOARDS, FIRMWARES, LIDARS
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.values import Twist

TICK = 0.01  # s
MINUTES = 30.0


class PiecesCable(Cable):
    """A line whose bytes arrive in pieces of any size. `sent_bytes` are those of the device."""

    def __init__(self) -> None:
        super().__init__(random=random.Random(7))
        self.sent_bytes: list[bytes] = []
        self._held = b""

    def write(self, data: bytes) -> None:
        self.sent_bytes.append(data)
        self._held += data
        size = len(self._held) - self.random.randrange(min(len(self._held), 12) + 1)
        super().write(self._held[:size])
        self._held = self._held[size:]

    def flush(self) -> None:
        """Send what is still on its way."""
        super().write(self._held)
        self._held = b""


def endure(name: str, minutes: float) -> tuple[int, int, int]:
    """Run a driver so long; return how many frames or beams were sent and understood, and frames rejected."""
    base, bus, cable, plant = load("create2", "lidar"), Bus(), PiecesCable(), StillPlant()
    firmware: Any = FIRMWARES[name](plant)  # type: ignore[arg-type]
    world, node = bus.node("world"), bus.node("driver")
    parser: Any = BOARDS[name](base) if name in BOARDS else LIDARS[name]()
    kind, read = (Counts if name in BOARDS else MeasuredBeams), list[Any]()
    take = parser.receive

    def listen(data: bytes) -> Iterator[Any]:
        for reading in take(data):
            if isinstance(reading, kind):
                read.extend([reading] * _count(reading))
            yield reading

    parser.receive = listen

    def advance() -> None:
        plant.time += TICK
        cable.write(firmware.receive(cable.read()) + firmware.tick())

    ticks = world.every(TICK, advance)
    commands = world.publish("cmd_vel", Twist)
    world.every(0.05, lambda: commands.send(Twist(0.1, 0.2)))
    lines: list[MemoryLine] = []

    def connect(user: Any, settings: Any) -> MemoryLine:
        lines.append(MemoryLine(node, cable, user, settings))
        return lines[-1]

    if name in BOARDS:
        BaseDriver(node, base, parser, connect)
    else:
        assert base.lidar
        LidarDriver(node, base.lidar, parser, connect, 0.0)
    bus.run(minutes * 60.0)
    ticks.cancel()
    cable.flush()
    bus.run(0.1)
    again: Any = BOARDS[name](base) if name in BOARDS else LIDARS[name]()
    sent = sum(_count(each) for piece in cable.sent_bytes for each in again.receive(piece) if isinstance(each, kind))
    return sent, len(read), parser.rejected


def _count(reading: Any) -> int:
    """The beams of a lidar; 1 for a reading of a board."""
    return len(reading.phases) if isinstance(reading, MeasuredBeams) else 1


def main() -> int:
    """Run each driver, and print what was lost."""
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else MINUTES
    failed = False
    for name in sys.argv[2:] or [*BOARDS, *LIDARS]:
        begun = time.monotonic()
        sent, understood, rejected = endure(name, minutes)
        lost = sent - understood
        failed = failed or lost > 0 or rejected > 0
        text = f"{sent} {'frames' if name in BOARDS else 'beams'} sent, {lost} lost, {rejected} rejected"
        sys.stdout.write(f"{name}: {minutes:g} min of simulated time in {time.monotonic() - begun:.0f} s: {text}\n")
        sys.stdout.flush()
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
