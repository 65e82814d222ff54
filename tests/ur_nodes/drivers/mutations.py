"""Mutated frames for every parser: python -m tests.ur_nodes.drivers.mutations COUNT [SEED [NAME ...]].

Frames of the stand-ins are damaged (flipped, lost, doubled, cut, mixed with noise) and given to the parsers. None may
raise; the memory of each stays bounded, and good frames are read again after the second one.
"""

import random
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from tests.base_contract import load

from ur_nodes.drivers.frames import FrameReader
from ur_nodes.drivers.readings import Counts, MeasuredBeams, Reply
from ur_nodes.drivers.registry import BOARDS, FIRMWARES, LIDARS

GROWTH = 10_000  # bytes that a parser may keep
BATCH = 64


class StillPlant:
    """What stand-ins ask of a robot, without one."""

    def __init__(self, base: str = "create2", variant: str = "lidar") -> None:
        self.base = load(base, variant)
        self.time = 0.0
        self.drift = 0.0, 0.0

    def turn_wheels(self, left: float, right: float) -> None:
        pass

    def rolled(self) -> tuple[float, float]:
        return self.time * 0.3, self.time * 0.2

    def battery(self) -> tuple[float, float, float, float]:
        return 14.0, -0.3, 2.0, 3.0

    def bumpers(self) -> dict[str, bool]:
        return {"left": int(self.time * 10) % 2 == 1, "right": False}

    def cliffs(self) -> dict[str, bool]:
        return {}

    def sonars(self) -> list[float]:
        return [1.0, 0.5, 9.0, *[2.0] * 13]

    def ranges(self) -> Any:
        return 1.0 + random.Random(int(self.time * 100)).random() + np.arange(360) / 100.0


def parsers() -> dict[str, Callable[[], Any]]:
    """Make each parser, by its name."""
    base = load("create2", "lidar")
    boards = {name: lambda make=make: make(base) for name, make in BOARDS.items()}
    return {**boards, **LIDARS}


def stream(name: str, seconds: float = 6.0) -> list[bytes]:
    """What the stand-in sends, in pieces as it sends them, after it was greeted."""
    plant = StillPlant()
    firmware = FIRMWARES[name](plant)  # type: ignore[arg-type]
    parser = parsers()[name]()
    pieces = [firmware.receive(parser.handshake())]
    pieces += [firmware.receive(each.data) for each in parser.receive(pieces[0]) if isinstance(each, Reply)]
    while plant.time < seconds:
        plant.time += 0.02
        asked = firmware.receive(parser.drive(0.1, 0.2)) if name in BOARDS else b""
        pieces.append(asked + firmware.tick())
    return [each for each in pieces if each]


def mutate(pieces: list[bytes], source: random.Random) -> Iterator[bytes]:
    """Damage pieces, one in one of six ways, without end."""
    while True:
        piece = bytearray(source.choice(pieces))
        kind, at = source.randrange(6), source.randrange(len(piece))
        if kind == 0:
            piece[at] ^= 1 << source.randrange(8)
        elif kind == 1:
            del piece[at : at + source.randrange(1, 9)]
        elif kind == 2:
            piece[at:at] = piece[at : at + source.randrange(1, 30)]
        elif kind == 3:
            del piece[at:]
        elif kind == 4:
            piece[at:at] = source.randbytes(source.randrange(1, 40))
        else:
            piece[at] = source.randrange(256)
        yield bytes(piece)


def attack(name: str, count: int, seed: int) -> None:
    """Give a parser so many mutated pieces; AssertionError where it misbehaves, and what it raises."""
    source = random.Random(f"{name} {seed}")
    pieces, parser = stream(name), parsers()[name]()
    list(parser.receive(pieces[0]))  # a Hokuyo answers with its parameters
    counts, most = Counts if name in BOARDS else MeasuredBeams, 0
    damaged = mutate(pieces, source)
    for number in range(count):
        list(parser.receive(next(damaged)))
        if number % BATCH == 0:
            most = max(most, count_kept(parser))
            at = source.randrange(len(pieces) - 20)
            again = [reading for piece in pieces[at : at + 20] for reading in parser.receive(piece)]
            assert any(isinstance(each, counts) for each in again), f"{name}: nothing is read after damage {number}"
    assert most < GROWTH, f"{name} keeps {most} bytes"


def count_kept(parser: object) -> int:
    """The bytes that a parser and its readers of frames keep."""
    values = vars(parser).values()
    inner = sum(count_kept(each) for each in values if isinstance(each, FrameReader))
    return inner + sum(len(each) for each in values if isinstance(each, bytes | list | tuple))


def main() -> int:
    """Attack every parser, and print how fast it was."""
    count, seed = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0
    for name in sys.argv[3:] or parsers():
        begun = time.monotonic()
        attack(name, count, seed)
        sys.stdout.write(f"{name}: {count} mutated pieces, no exception, {time.monotonic() - begun:.0f} s\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
