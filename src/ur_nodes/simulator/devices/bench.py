"""The devices of a simulated robot: those that the drivers of its base file open, each with a stand-in behind it."""

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from ur.robot.base import Base
from ur.source.diagnostic import UserError, error
from ur_nodes.drivers.registry import FIRMWARES
from ur_nodes.simulator.devices.plant import Plant
from ur_nodes.simulator.devices.terminal import DeviceTerminal
from ur_nodes.simulator.simulation import Simulation


class Wire(Protocol):
    """A device's end of a line."""

    def read(self) -> bytes:
        """Return what the driver has sent."""

    def write(self, data: bytes) -> None:
        """Send bytes to the driver."""

    def close(self) -> None:
        """Unplug it."""


class DeviceBench:
    """The stand-ins of one robot. `covers` are the keys of sensors that they report, in place of simulated topics."""

    def __init__(
        self, simulation: Simulation, folder: Path, seed: int = 0, connect: Callable[[Path], Wire] = DeviceTerminal
    ) -> None:
        """`connect` makes the end of a line below `folder`. Raises UserError: the base has no driver of ours."""
        self.plant = Plant(simulation, 0, seed)
        drivers = list_own_drivers(simulation.base)
        self.firmwares = {path: FIRMWARES[protocol](self.plant) for path, protocol in drivers.items()}
        self.wires = {path: connect(folder / Path(path).name) for path in drivers}
        self.covers = frozenset[str]().union(*(each.covers for each in self.firmwares.values()))

    def step(self) -> None:
        """The simulation went on: devices obey and report."""
        self.plant.update()
        for path, firmware in self.firmwares.items():
            wire = self.wires[path]
            data = wire.read()
            wire.write((firmware.receive(data) if data else b"") + firmware.tick())

    def close(self) -> None:
        """Unplug all of them."""
        for wire in self.wires.values():
            wire.close()


def list_own_drivers(base: Base) -> dict[str, str]:
    """The protocols of a base's drivers that are ours, by their device files. Raises UserError: there is none."""
    drivers = (*((base.driver,) if base.driver else ()), *base.drivers)
    found = {driver.device: driver.protocol for driver in drivers if driver.protocol in FIRMWARES}
    if base.driver is None or base.driver.protocol not in FIRMWARES:
        text = f"base {base.name!r} has no driver of this project, expected one of {', '.join(FIRMWARES)} as its driver"
        raise UserError(error(text, rule="no-device", help="simulate it without its driver: simulate:=true"))
    return found
