"""Stand-ins of all boards on pseudo-terminals, in real time; notes when the motors of a board begin to turn, and rest.

Arguments: the folder of the devices, and the file of the notes: a line each, with the time (monotonic, s), the board,
and whether its motors turn. A stand-in goes on with its last command, as the manual of its board says.
"""

import sys
import time
from pathlib import Path
from typing import TextIO

from ur.robot.base import load_base
from ur.source.project import launch_library
from ur_nodes.drivers.registry import BOARDS, FIRMWARES
from ur_nodes.simulator.devices.bench import DeviceTerminal

RESTS = 0.0011  # m/s: a Neato stops by 1 mm/s


class RollingPlant:
    """See ur_nodes.simulator.devices.plant.Plant: wheels that turn at once, and nothing else."""

    def __init__(self, name: str, notes: TextIO) -> None:
        self.base = load_base(launch_library(), "create2")
        self.name, self.notes = name, notes
        self.time = time.monotonic()
        self.speeds, self.turned = (0.0, 0.0), [0.0, 0.0]

    def update(self) -> None:
        now = time.monotonic()
        self.turned = [
            rolled + speed * (now - self.time) for rolled, speed in zip(self.turned, self.speeds, strict=True)
        ]
        self.time = now

    def turn_wheels(self, left: float, right: float) -> None:
        moves, moved = (max(map(abs, each)) > RESTS for each in ((left, right), self.speeds))
        self.speeds = left, right
        if moves is not moved:
            self.notes.write(f"{time.monotonic()} {self.name} {int(moves)}\n")
            self.notes.flush()

    def rolled(self) -> tuple[float, float]:
        return self.turned[0], self.turned[1]

    def battery(self) -> tuple[float, float, float, float]:
        return 14.0, -0.3, 2.0, 3.0

    def bumpers(self) -> dict[str, bool]:
        return {}

    cliffs = bumpers

    def sonars(self) -> list[float]:
        return []


def main(folder: Path, notes: TextIO) -> None:
    """Run until the end of the process."""
    plants = [RollingPlant(name, notes) for name in BOARDS]
    firmwares = [FIRMWARES[plant.name](plant) for plant in plants]  # type: ignore[arg-type]
    wires = [DeviceTerminal(folder / plant.name) for plant in plants]
    folder.chmod(0o755)
    for wire in wires:
        wire.path.resolve().chmod(0o666)
    while True:
        for plant, firmware, wire in zip(plants, firmwares, wires, strict=True):
            plant.update()
            data = wire.read()
            wire.write((firmware.receive(data) if data else b"") + firmware.tick())
        time.sleep(0.002)


if __name__ == "__main__":
    with Path(sys.argv[2]).open("w") as opened:
        main(Path(sys.argv[1]), opened)
