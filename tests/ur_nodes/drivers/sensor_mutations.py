"""Mutated data for readers of sensors without a scan: python -m tests.ur_nodes.drivers.sensor_mutations COUNT [SEED].

Edges of echo pins and registers of inertial units are damaged. No reader may raise, nor fail to read again.
"""

import random
import sys
import time
from collections.abc import Callable

from tests.ur_nodes.drivers.imus.units import BoschUnit, InvenSenseUnit, Unit
from tests.ur_nodes.drivers.mutations import BATCH

from ur_nodes.drivers.imus.bno055 import Bno055
from ur_nodes.drivers.imus.imu import InertialDevice
from ur_nodes.drivers.imus.mpu6050 import STILL, Mpu6050
from ur_nodes.drivers.sonars.echoes import PinEdge, find_echo


def attack_echoes(count: int, source: random.Random) -> None:
    """Add edges to a pulse, and lose some."""
    for _ in range(count):
        end = 1_450_000 + round(2.0 * source.uniform(0.05, 6.0) / 343.0 * 1e9)
        edges = [PinEdge(21, True, 1_450_000), PinEdge(21, False, end)]
        for _ in range(source.randrange(4)):
            edge = PinEdge(source.choice((21, 16)), source.random() < 0.5, source.randrange(-(1 << 62), 1 << 62))
            edges.insert(source.randrange(len(edges) + 1), edge)
        del edges[: source.randrange(2)]
        echo = find_echo(edges, 21, 1_000_000)
        assert echo is None or echo.distance > 0.01


def attack_unit(count: int, source: random.Random, unit: Unit, device: InertialDevice) -> None:
    """Flip one byte of a hundred that a unit is read by, and take its power now and then."""
    unit.random, unit.noise = source, 0.01
    for number in range(count):
        device.read(unit)
        if number % 1000 == 0:
            unit.lose_power()
        if number % BATCH == 0:
            unit.noise = 0.0
            device.begin(unit)
            again = [device.read(unit) for _ in range(STILL + 1)]
            assert again[-1] is not None, f"nothing is read after damage {number}"
            unit.noise = 0.01


ATTACKS: dict[str, Callable[[int, random.Random], None]] = {
    "echoes": attack_echoes,
    "bno055": lambda count, source: attack_unit(count, source, BoschUnit(), Bno055(lambda _: None)),
    "mpu6050": lambda count, source: attack_unit(count, source, InvenSenseUnit(), Mpu6050(lambda _: None)),
}


def main() -> int:
    """Attack every reader, and print how fast it was."""
    count, seed = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0
    for name, attack in ATTACKS.items():
        begun = time.monotonic()
        attack(count, random.Random(f"{name} {seed}"))
        sys.stdout.write(f"{name}: {count} mutated pieces, no exception, {time.monotonic() - begun:.0f} s\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
