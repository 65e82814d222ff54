"""The devices of a simulated robot: those that the drivers of its base file open, each with a stand-in behind it."""

import contextlib
import fcntl
import os
import tty
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from ur.robot.base import Base
from ur.source.diagnostic import user_error
from ur_nodes.drivers.registry import FIRMWARES
from ur_nodes.simulator.devices.plant import Plant
from ur_nodes.simulator.simulation import Simulation

_MOST = 65536


class DeviceTerminal:
    """The device's end of a serial line. Bytes that no driver reads are lost when the line is full, as on a wire."""

    def __init__(self, path: Path) -> None:
        """Raises UserError: the folder of `path` is another user's, or a device of that name is in use."""
        self.path = path
        _make_folder(path.parent)
        self._lock = _lock(path)
        if path.is_symlink():
            path.unlink()  # of a simulator that was killed
        self._ours, self._theirs = os.openpty()
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        path.symlink_to(os.ttyname(self._theirs))

    def read(self) -> bytes:
        """Return what the driver has sent."""
        with contextlib.suppress(BlockingIOError):
            return os.read(self._ours, _MOST)
        return b""

    def write(self, data: bytes) -> None:
        """Send bytes to the driver."""
        if data:
            with contextlib.suppress(BlockingIOError):
                os.write(self._ours, data)

    def close(self) -> None:
        """Unplug it."""
        with contextlib.suppress(FileNotFoundError):
            self.path.unlink()
        for number in (self._ours, self._theirs, self._lock):
            os.close(number)


def _lock(path: Path) -> int:
    """Hold the name of a device as long as the returned file is open. Raises UserError: another simulator holds it."""
    number = os.open(path.parent / f".{path.name}.lock", os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
    try:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(number)
        text = f"{path} is a device of another simulator, expected a folder that no other one uses"
        raise user_error(text, rule="no-device-folder", help="give another one: device_folder:=FOLDER") from None
    return number


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        owner = folder.lstat()
    except OSError as problem:
        text = f"{folder} cannot be made for the devices of the simulated robot: {problem.strerror}"
        raise user_error(text, rule="no-device-folder") from None
    if owner.st_uid != os.geteuid() or folder.is_symlink():
        text = f"{folder} is another user's, expected a folder of your own for the devices of the simulated robot"
        raise user_error(text, rule="no-device-folder", help="give another one: device_folder:=FOLDER")


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
        raise user_error(text, rule="no-device", help="simulate it without its driver: simulate:=true")
    return found
