"""Faults of boards, lidars and lines: python -m tests.ur_nodes.drivers.faults [COUNT] [NAME ...].

COUNT (20) seeded runs for each device and fault. A board drives off, has the fault at a random moment, and ends: how
long the robot moved after the fault (or after its last command, where it goes on driving), whether a line names the
device, and whether it drives again without a restart. A lidar scans in place of that: how long a scan is published
after the fault, and whether beams are wrong. Exit code 1 where one of them is not as it should be.
"""

import random
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from tests.ur_nodes.drivers import test_base_driver, test_lidar_driver
from tests.ur_nodes.drivers.rig import Cable, DriverRig, MemoryLine
from tests.ur_nodes.drivers.test_base_driver import REST

from ur_nodes.drivers.registry import BOARDS, LIDARS
from ur_nodes.ports.values import Scan

LIMIT = 0.3  # s
UNPLUGGED = {"create2": 3.0, "loki": 3.0, "magni": 0.7, "neato": 0.4, "turtlebot3": 0.7}
"""s; an unplugged board is stopped by its own watchdog: a Create 2 and a Loki have none, a Magni's is a guess of its
stand-in, the commands of a Neato last 0.35 s, a TurtleBot3 waits 0.5 s for its heartbeat."""
FAST = 0.25  # m/s
NOT_REPORTED = {"loki": ("emergency stop", "low battery")}
"""Faults that a board does not know of."""
COUNTERS = {"arduino": 31, "create2": 16, "neato": 31, "turtlebot3": 31}
"""Bits after which counters wrap; a Magni reports differences."""
WRAP_WITHIN = 500  # counts: 0.03 to 0.5 m
FALSE = 0.15  # m that a beam may be off
MOST_FALSE = {"ydlidar": 40, "lds02": 40}
"""Beams of a scan with noise: samples of an RPLIDAR have no checksum, and these two move beams by their distances."""


@dataclass(frozen=True, slots=True)
class Faulty:
    """A device with a fault: its robot, its line and both ends."""

    rig: DriverRig
    cable: Cable
    firmware: Any
    line: MemoryLine


def _nothing(*_: object) -> None: ...


@dataclass(frozen=True, slots=True)
class DeviceFault:
    """A fault: `begin` and `end` it; `stops` the robot by itself, `back`: it drives again, `line` is reported.

    `silent` is reported for a lidar. `prepare` is called before the driver starts, and `never` is not reported.
    """

    begin: Callable[[Faulty, random.Random], None]
    end: Callable[[Faulty], None]
    stops: bool = True
    back: bool = True
    line: str = "/dev/test: "
    silent: str = ""
    prepare: Callable[[Faulty, random.Random], None] = _nothing
    never: str = "no such line"


def _set(**values: Any) -> Callable[[Faulty, random.Random], None]:
    def begin(faulty: Faulty, source: random.Random) -> None:
        faulty.cable.random = source
        for name, value in values.items():
            setattr(faulty.cable, name, value)

    return begin


def _clear(faulty: Faulty) -> None:
    faulty.cable.plugged, faulty.cable.noise, faulty.cable.cut, faulty.cable.late = True, 0.0, 0.0, 0.0


def _replace(faulty: Faulty, _: random.Random) -> None:
    """Another device answers."""
    firmware = faulty.firmware
    firmware.kept = (firmware.receive, firmware.tick)
    if faulty.rig.base.lidar is None:
        faulty.rig.bench.plant.turn_wheels(0.0, 0.0)  # the board itself is away
    firmware.receive = lambda data: b"AT+OK\r\n" if data else b""
    firmware.tick = lambda: b"$GPGGA,noise*00\r\n"
    faulty.cable.plugged = False
    faulty.rig.bus.run(0.05)
    faulty.cable.plugged = True


def _restore(faulty: Faulty) -> None:
    faulty.firmware.receive, faulty.firmware.tick = faulty.firmware.kept
    faulty.cable.plugged = False
    faulty.rig.bus.run(0.1)
    faulty.cable.plugged = True


def _kill(faulty: Faulty, _: random.Random) -> None:
    faulty.line.dead = True


def _press(faulty: Faulty, _: random.Random) -> None:
    name = "lifted" if hasattr(faulty.firmware, "lifted") else "power"
    setattr(faulty.firmware, name, name == "lifted")


def _release(faulty: Faulty) -> None:
    name = "lifted" if hasattr(faulty.firmware, "lifted") else "power"
    setattr(faulty.firmware, name, name == "power")


def _empty(faulty: Faulty, _: random.Random) -> None:
    faulty.rig.bench.plant.battery = lambda: (9.0, -0.2, 0.1, 3.0)  # type: ignore[method-assign]


def _begin_counters(faulty: Faulty, source: random.Random) -> None:
    protocol = faulty.rig.base.driver.protocol if faulty.rig.base.driver else ""
    if protocol in COUNTERS:
        faulty.firmware._counted = 2 ** COUNTERS[protocol] - 1 - source.randrange(WRAP_WITHIN)


LINE_FAULTS: dict[str, DeviceFault] = {
    "late answers": DeviceFault(_set(late=5.0), _clear, line="no wheel counts for", silent="no beams of"),
    "noise": DeviceFault(_set(noise=0.001), _clear, stops=False, line=""),
    "half frames": DeviceFault(_set(cut=0.05), _clear, stops=False, line=""),
    "killed": DeviceFault(_kill, _nothing, back=False, line=""),
    "wrong device": DeviceFault(_replace, _restore, silent="no beams of"),
    "unplugged for 5 s": DeviceFault(_set(plugged=False), _clear, silent="it was unplugged"),
}
FAULTS: dict[str, DeviceFault] = LINE_FAULTS | {
    "emergency stop": DeviceFault(_press, _release, line="does not drive: "),
    "low battery": DeviceFault(_empty, _nothing, stops=False, line="the battery is empty"),
    "counters wrap": DeviceFault(
        _nothing, _nothing, stops=False, line="", prepare=_begin_counters, never="wheel counts jumped"
    ),
}


def try_fault(board: str, name: str, seed: int) -> tuple[float, list[str]]:
    """Try a fault of a board once; return how long the robot moved on (s), and what was wrong."""
    fault, source, rig = FAULTS[name], random.Random(f"{board} {name} {seed}"), test_base_driver.make_rig(board)
    faulty = Faulty(rig, rig.cable, rig.firmware, rig.lines[0])
    fault.prepare(faulty, source)
    rig.drive(0.0, 0.0, 1.0)
    rig.bus.nodes["/base_driver"].lines.clear()  # counters that begin elsewhere have jumped
    wrong = [] if rig.drive_until(lambda: rig.truth.twist.forward > FAST, 0.3, 0.0, 3.0) else ["does not drive off"]
    rig.bus.run(source.random() * 0.05)
    fault.begin(faulty, source)
    driving = 1.0 if not fault.stops else 0.0
    rig.drive(0.3, 0.0, driving)
    begun = rig.bus.now
    stopped = rig.bus.run_until(lambda: abs(rig.truth.twist.forward) < REST and abs(rig.truth.twist.turn) < REST, 3.0)
    moved = (rig.bus.now - begun) / 1e9
    without = name.startswith("unplugged") and board in ("create2", "loki")
    wrong += [] if stopped or without else ["does not stop"]
    if name != "killed":
        rig.drive(0.3, 0.0, 5.0 - driving)
    wrong += _judge_lines(rig, "/base_driver", fault.line, fault.never)
    fault.end(faulty)
    if fault.back:
        rig.drive(0.0, 0.0, 6.0)
        back = rig.drive_until(lambda: rig.truth.twist.forward > FAST, 0.3, 0.0, 3.0)
        wrong += [] if back else ["does not drive again"]
    return moved, wrong


def try_lidar_fault(lidar: str, name: str, seed: int) -> tuple[float, list[str]]:
    """Try a fault of a lidar once; return when its last scan was published (s after the fault), and what was wrong."""
    fault, source, rig = LINE_FAULTS[name], random.Random(f"{lidar} {name} {seed}"), test_lidar_driver.make_rig(lidar)
    path = next(each for each in rig.cables if each != "/dev/create")
    faulty = Faulty(rig, rig.cables[path], rig.bench.firmwares[path], rig.lines[-1])
    scans = rig.record("scan", Scan)
    wrong = [] if rig.bus.run_until(lambda: bool(scans), 3.0) else ["does not scan"]
    rig.bus.run(source.random() * 0.2)
    exact = rig.simulation.scan(0)
    fault.begin(faulty, source)
    begun, last, count = rig.bus.now, 0.0, len(scans)
    if rig.bus.run_until(lambda: len(scans) > count, 1.0):
        last = (rig.bus.now - begun) / 1e9
    rig.bus.run(0.5)
    silent = len(scans)
    rig.bus.run(3.3)  # before bytes that are 5 s late arrive
    if len(scans) > silent and fault.stops:
        wrong.append("scans go on")
    most = MOST_FALSE.get(lidar, 12)
    if any(_count_false(scan, exact) > most for scan in scans):
        wrong.append(f"more than {most} beams of a scan are false")
    wrong += _judge_lines(rig, "/lidar_driver", fault.silent, fault.never)
    fault.end(faulty)
    if fault.back:
        rig.bus.run(6.0)
        count = len(scans)
        rig.bus.run(1.0)
        wrong += [] if len(scans) > count + 3 else ["does not scan again"]
    return last, wrong


def list_faults(device: str) -> list[str]:
    """The faults of a device that it knows of."""
    return [each for each in (FAULTS if device in BOARDS else LINE_FAULTS) if each not in NOT_REPORTED.get(device, ())]


def _count_false(scan: Scan, exact: Any) -> int:
    error = np.abs(scan.ranges - exact)[np.isfinite(scan.ranges) & np.isfinite(exact)]
    return int(np.count_nonzero(error > FALSE))


def _judge_lines(rig: DriverRig, node: str, wanted: str, never: str) -> list[str]:
    lines = [text for _, text in rig.bus.nodes[node].lines]
    wrong = [] if not wanted or any(wanted in line for line in lines) else [f"no line with {wanted!r}"]
    return wrong + ([f"a line with {never!r}"] if any(never in line for line in lines) else [])


def main() -> int:
    """Try each fault for each device, and print a line for each."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    failed = False
    for device in sys.argv[2:] or sorted({*BOARDS, *LIDARS}):
        for name in list_faults(device):
            if device in BOARDS:
                failed |= _report_board(device, name, count)
            else:
                results = [try_lidar_fault(device, name, seed) for seed in range(count)]
                wrong = sorted({text for _, texts in results for text in texts})
                failed |= bool(wrong)
                last = f"{count} runs, the last scan at most {max(last for last, _ in results):.3f} s after it"
                sys.stdout.write(f"{device} {name}: {last if LINE_FAULTS[name].stops else f'{count} runs'}: ")
                sys.stdout.write(f"{'; '.join(wrong) or 'right'}\n")
            sys.stdout.flush()
    return int(failed)


def _report_board(board: str, name: str, count: int) -> bool:
    """Print the line of a fault of a board; return whether a run failed."""
    limit = UNPLUGGED.get(board, LIMIT) if name.startswith("unplugged") else LIMIT
    results = [try_fault(board, name, seed) for seed in range(count)]
    longest = max(moved for moved, _ in results)
    wrong = sorted({text for _, texts in results for text in texts})
    late = [] if longest <= limit else [f"moved longer than {limit} s"]
    right = "right" if limit == LIMIT else f"its own watchdog stops it, or none (up to {limit} s here)"
    sys.stdout.write(f"{board} {name}: {count} runs, at rest within {longest:.3f} s: ")
    sys.stdout.write(f"{'; '.join([*wrong, *late]) or right}\n")
    return bool(wrong or late)


if __name__ == "__main__":
    sys.exit(main())
