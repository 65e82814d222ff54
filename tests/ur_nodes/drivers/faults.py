"""Faults of boards and lines while the robot drives: python -m tests.ur_nodes.drivers.faults [COUNT] [BOARD ...].

COUNT (20) seeded runs for each board and fault. Each run drives off, has the fault at a random moment, and ends: how
long the robot moved after the fault (or after its last command, where it goes on driving), whether a line names the
device, and whether it drives again without a restart. Exit code 1 where one of them is not as it should be.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from tests.ur_nodes.drivers.rig import DriverRig
from tests.ur_nodes.drivers.test_base_driver import REST, make_rig

from ur_nodes.drivers.boards import BOARDS

LIMIT = 0.3  # s
UNPLUGGED = {"create2": 3.0, "loki": 3.0, "magni": 0.7, "neato": 0.4, "turtlebot3": 0.7}
"""s; an unplugged board is stopped by its own watchdog: a Create 2 and a Loki have none, a Magni's is a guess of its
stand-in, the commands of a Neato last 0.35 s, a TurtleBot3 waits 0.5 s for its heartbeat."""
FAST = 0.25  # m/s
NOT_REPORTED = {"loki": ("emergency stop", "low battery")}
"""Faults that a board does not know of."""


@dataclass(frozen=True, slots=True)
class DeviceFault:
    """A fault: `begin` and `end` it; `stops` the robot by itself, `back`: it drives again, `line` is reported."""

    begin: Callable[[DriverRig, random.Random], None]
    end: Callable[[DriverRig], None]
    stops: bool = True
    back: bool = True
    line: str = "/dev/test: "


def _set(**values: Any) -> Callable[[DriverRig, random.Random], None]:
    def begin(rig: DriverRig, source: random.Random) -> None:
        rig.cable.random = source
        for name, value in values.items():
            setattr(rig.cable, name, value)

    return begin


def _clear(rig: DriverRig) -> None:
    rig.cable.plugged, rig.cable.noise, rig.cable.cut, rig.cable.late = True, 0.0, 0.0, 0.0


def _replace(rig: DriverRig, _: random.Random) -> None:
    """Another device answers."""
    firmware = rig.firmware
    rig.kept = (firmware.take, firmware.tick)  # type: ignore[attr-defined]
    rig.bench.plant.turn_wheels(0.0, 0.0)  # the board itself is away
    firmware.take = lambda data: b"AT+OK\r\n" if data else b""
    firmware.tick = lambda: b"$GPGGA,noise*00\r\n"
    rig.cable.plugged = False


def _restore(rig: DriverRig) -> None:
    rig.firmware.take, rig.firmware.tick = rig.kept  # type: ignore[attr-defined]
    rig.cable.plugged = False
    rig.bus.run(0.1)
    rig.cable.plugged = True


def _kill(rig: DriverRig, _: random.Random) -> None:
    for line in rig.lines:
        line.dead = True


def _press(rig: DriverRig, _: random.Random) -> None:
    setattr(rig.firmware, "lifted" if hasattr(rig.firmware, "lifted") else "power", hasattr(rig.firmware, "lifted"))


def _release(rig: DriverRig) -> None:
    setattr(rig.firmware, "lifted" if hasattr(rig.firmware, "lifted") else "power", not hasattr(rig.firmware, "lifted"))


def _empty(rig: DriverRig, _: random.Random) -> None:
    rig.bench.plant.battery = lambda: (9.0, -0.2, 0.1, 3.0)  # type: ignore[method-assign]


def _nothing(_: DriverRig) -> None: ...


FAULTS: dict[str, DeviceFault] = {
    "late answers": DeviceFault(_set(late=5.0), _clear, line="no wheel counts for"),
    "noise": DeviceFault(_set(noise=0.001), _clear, stops=False, line=""),
    "half frames": DeviceFault(_set(cut=0.05), _clear, stops=False, line=""),
    "emergency stop": DeviceFault(_press, _release, line="does not drive: "),
    "low battery": DeviceFault(_empty, _nothing, stops=False, line="the battery is empty"),
    "killed": DeviceFault(_kill, _nothing, back=False, line=""),
    "wrong device": DeviceFault(_replace, _restore),
    "unplugged for 5 s": DeviceFault(_set(plugged=False), _clear),
}


def try_fault(board: str, name: str, seed: int) -> tuple[float, list[str]]:
    """Try a fault once; return how long the robot moved on (s), and what was wrong."""
    fault, source, rig = FAULTS[name], random.Random(f"{board} {name} {seed}"), make_rig(board)
    rig.drive(0.0, 0.0, 1.0)
    wrong = [] if rig.drive_until(lambda: rig.truth.twist.forward > FAST, 0.3, 0.0, 3.0) else ["does not drive off"]
    rig.bus.run(source.random() * 0.05)
    fault.begin(rig, source)
    driving = 1.0 if not fault.stops else 0.0
    rig.drive(0.3, 0.0, driving)
    begun = rig.bus.now
    stopped = rig.bus.run_until(lambda: abs(rig.truth.twist.forward) < REST and abs(rig.truth.twist.turn) < REST, 3.0)
    moved = (rig.bus.now - begun) / 1e9
    without = name.startswith("unplugged") and board in ("create2", "loki")
    wrong += [] if stopped or without else ["does not stop"]
    if name != "killed":
        rig.drive(0.3, 0.0, 5.0 - driving)
    lines = [text for _, text in rig.bus.nodes["/base_driver"].lines]
    wrong += [] if any(fault.line in line for line in lines) else [f"no line with {fault.line!r}"]
    fault.end(rig)
    if fault.back:
        rig.drive(0.0, 0.0, 6.0)
        back = rig.drive_until(lambda: rig.truth.twist.forward > FAST, 0.3, 0.0, 3.0)
        wrong += [] if back else ["does not drive again"]
    return moved, wrong


def main() -> int:
    """Try each fault for each board, and print a line for each."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    failed = False
    for board in sys.argv[2:] or sorted(BOARDS):
        for name in (each for each in FAULTS if each not in NOT_REPORTED.get(board, ())):
            limit = UNPLUGGED.get(board, LIMIT) if name.startswith("unplugged") else LIMIT
            results = [try_fault(board, name, seed) for seed in range(count)]
            longest = max(moved for moved, _ in results)
            wrong = sorted({text for _, texts in results for text in texts})
            late = [] if longest <= limit else [f"moved longer than {limit} s"]
            failed = failed or bool(wrong or late)
            right = "right" if limit == LIMIT else f"its own watchdog stops it, or none (up to {limit} s here)"
            text = "; ".join([*wrong, *late]) or right
            sys.stdout.write(f"{board} {name}: {count} runs, at rest within {longest:.3f} s: {text}\n")
            sys.stdout.flush()
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
