"""Faults of sensors without a scan: python -m tests.ur_nodes.drivers.sensor_faults [COUNT].

COUNT (20) seeded runs for each sensor and fault. In each the sensor measures, has the fault at a random moment for 5 s,
and is sound again: no reading may be wrong, a line names the device where it is silent, and readings come again without
a restart. Exit code 1 where one of them is not as it should be.
"""

import random
import sys
from collections.abc import Callable, Iterator
from typing import Any

from tests.ur_nodes.drivers.imus.test_imu_driver import DrivenUnit
from tests.ur_nodes.drivers.sonars.test_sonar_driver import AT, Sonars

SECONDS = 5.0
Fault = Callable[[Any, random.Random], None]


def _set(part: str, **values: Any) -> Fault:
    def begin(rig: Any, source: random.Random) -> None:
        target = getattr(rig, part)
        target.random = source
        for name, value in values.items():
            setattr(target, name, value)

    return begin


def _wrong_unit(rig: Any, _: random.Random) -> None:
    """Another chip answers at its address."""
    rig.unit.registers[0] = rig.unit.registers[0x75] = 0x12
    rig.unit.plugged = False
    rig.bus.run(1.0)
    rig.unit.plugged = True


def _lose_power(rig: Any, _: random.Random) -> None:
    rig.unit.lose_power()


def _repair(rig: Any) -> None:
    """All is sound again, and plugged in."""
    if isinstance(rig, Sonars):
        rig.board.plugged, rig.board.noise, rig.board.cut, rig.board.silent = True, 0.0, 0.0, frozenset()
    else:
        rig.unit.plugged = False
        rig.bus.run(0.1)
        rig.unit.plugged, rig.unit.noise = True, 0.0
        rig.unit.lose_power()


UNIT_FAULTS = {
    "unplugged for 5 s": (_set("unit", plugged=False), "remote i/o error; expected a "),
    "wrong device": (_wrong_unit, "is 0x12, expected"),
    "power lost": (_lose_power, ""),
}
FAULTS: dict[str, dict[str, tuple[Fault, str]]] = {
    "sonars": {
        "unplugged for 5 s": (_set("board", plugged=False), "no such device; expected the GPIO chip"),
        "wrong device": (_set("board", silent=frozenset(AT)), "no echo of any sonar"),
        "noise": (_set("board", noise=0.2), ""),
        "half frames": (_set("board", cut=0.2), ""),
    },
    "bno055": {**UNIT_FAULTS, "noise": (_set("unit", noise=0.001), "")},
    "mpu6050": UNIT_FAULTS,
}
MAKE: dict[str, Callable[[], Any]] = {
    "sonars": Sonars,
    "bno055": lambda: DrivenUnit("bno055"),
    "mpu6050": lambda: DrivenUnit("mpu6050"),
}


def readings_of(rig: Any) -> list[Any]:
    """What the driver has published."""
    readings: list[Any] = rig.ranges if isinstance(rig, Sonars) else rig.readings
    return readings


def find_wrong(rig: Any) -> Iterator[str]:
    """Yield each reading that is not what was measured; noise on an I2C bus has no checksum to find it by."""
    distances = dict(zip((f"sonar_{n}" for n in range(5)), AT.values(), strict=True))
    for each in rig.ranges if isinstance(rig, Sonars) else ():
        if each.frame != "sonar_4" and abs(each.range - distances[each.frame]) > 0.06:
            yield f"{each.frame} at {each.range:.2f} m"


def try_fault(sensor: str, name: str, seed: int) -> list[str]:
    """Try a fault once; return what was wrong."""
    begin, line = FAULTS[sensor][name]
    source, rig = random.Random(f"{sensor} {name} {seed}"), MAKE[sensor]()
    rig.bus.run(3.0 + source.random())
    wrong = [] if readings_of(rig) else ["no readings at first"]
    begin(rig, source)
    rig.bus.run(SECONDS)
    if line and not any(line in each for each in rig.lines):
        wrong.append(f"no line with {line!r}")
    _repair(rig)
    rig.bus.run(3.0)
    count = len(readings_of(rig))
    rig.bus.run(3.0)
    wrong += [] if len(readings_of(rig)) > count + 10 else ["no readings again"]
    return [*wrong, *find_wrong(rig)]


def main() -> int:
    """Try each fault of each sensor, and print a line for each."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    failed = False
    for sensor, faults in FAULTS.items():
        for name in faults:
            wrong = sorted({text for seed in range(count) for text in try_fault(sensor, name, seed)})
            failed = failed or bool(wrong)
            sys.stdout.write(f"{sensor} {name}: {count} runs: {'; '.join(wrong) or 'right'}\n")
            sys.stdout.flush()
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
