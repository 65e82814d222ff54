"""A simulated robot whose devices are stand-ins, and the real driver behind them, on a bus in memory.

The line has the faults of real ones: unplugged, noise, lost halves of frames, answers that are late.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from tests.ur_nodes.first_drive.stage import DrivenStage

from ur.robot.base import Base
from ur.worlds.world_file import read_world
from ur_nodes.drivers.base_driver import BaseDriver
from ur_nodes.drivers.health import Report
from ur_nodes.drivers.lidar_driver import LidarDriver
from ur_nodes.drivers.lines.line import DeviceLine, LineSettings, LineUser
from ur_nodes.drivers.registry import LIDARS, make_board
from ur_nodes.memory.node import MemoryNode
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.simulator import simulator_node
from ur_nodes.simulator.devices.bench import DeviceBench
from ur_nodes.simulator.operation import Operation
from ur_nodes.simulator.settings import read_settings

GUARD = 0.15  # s, as the guard process


def one_of(names: Iterable[str], name: str) -> list[object]:
    """Parameters for devices of one kind: the other names are for tests/nightly."""
    return [pytest.param(each, marks=[] if each == name else [pytest.mark.nightly]) for each in sorted(names)]


@dataclass
class Cable:
    """Both ends of a line. `noise` is the share of bytes with a flipped bit, `late` s that bytes of the device take."""

    noise: float = 0.0
    late: float = 0.0
    cut: float = 0.0
    """The share of reads of which a half is lost."""
    plugged: bool = True
    random: random.Random = field(default_factory=lambda: random.Random(1))
    to_device: bytes = b""
    waiting: list[tuple[int, bytes]] = field(default_factory=list)
    sent: bytes = b""
    """All that the driver has sent."""

    def read(self) -> bytes:
        """Of the device."""
        data, self.to_device = self.to_device, b""
        return self._damage(data)

    def write(self, data: bytes) -> None:
        """Of the device."""
        if data and self.plugged:
            self.waiting.append((0, self._damage(data)))

    def close(self) -> None:
        """Of the device."""
        self.plugged = False

    def _damage(self, data: bytes) -> bytes:
        if data and self.random.random() < self.cut:
            data = data[: len(data) // 2]
        if not self.noise:
            return data
        flip = self.random.random
        return bytes(each ^ (1 << self.random.randrange(8)) if flip() < self.noise else each for each in data)


class MemoryLine:
    """The driver's end: see DeviceLine. With `stop` it is guarded as a serial line is."""

    def __init__(self, node: Node, cable: Cable, user: LineUser, settings: LineSettings) -> None:
        self.name = "/dev/test"
        self._node, self._cable, self._user, self._stop = node, cable, user, settings.stop
        self._leave = settings.shutdown
        self._open = False
        self._moving = -1.0
        self.dead = False  # the driver's process was killed
        node.every(0.005, self._look)

    def write(self, data: bytes, *, moving: bool = False) -> None:
        if self._open and not self.dead:
            self._cable.to_device += data
            self._cable.sent += data
            self._moving = self._node.steady() if moving else -1.0

    def close(self) -> None:
        self._open = False

    def _look(self) -> None:
        cable, now = self._cable, self._node.now()
        if self.dead:
            if self._stop and self._moving >= 0.0:
                cable.to_device += self._stop + self._leave
                self._moving = -1.0
            return
        if cable.plugged is not self._open:
            self._open = cable.plugged
            cable.to_device, cable.waiting = b"", []
            if self._open:
                self._user.opened()
            else:
                self._user.lost("it was unplugged")
        cable.waiting = [(due or now + round(cable.late * SECOND), data) for due, data in cable.waiting]
        while cable.waiting and cable.waiting[0][0] <= now:
            _, data = cable.waiting.pop(0)
            self._user.received(data, now)


class DriverRig(DrivenStage):
    """A stage whose robot is driven through the devices of a base; `firmware` is that of the board."""

    def __init__(
        self,
        base: str = "create2",
        *,
        change: Callable[[Base], Base] | None = None,
        report: Report = lambda _: None,
        **parameters: Any,
    ) -> None:
        self._report = report
        self.orphaned = False
        self.cables: dict[str, Cable] = {}
        self._change = change or (lambda base: base)
        self.lines: list[MemoryLine] = []
        super().__init__(base=base, **parameters)

    def add(
        self, name: str, start: Callable[[Node], object], remaps: dict[str, str] | None = None, **parameters: Any
    ) -> MemoryNode:
        if start is not simulator_node.start:
            return super().add(name, start, remaps, **parameters)
        self.base = self._change(self.base)
        return super().add(name, self._start, remaps, **parameters)

    def _start(self, node: Node) -> None:
        own = node.parameters
        world = read_world(own.text("world_file"))
        settings = read_settings(own, simulated_clock=False)
        simulation = simulator_node.make_simulation(own, world, self.base)
        seed = own.integer("seed", 0)
        self.bench = DeviceBench(simulation, Path("/dev"), seed, connect=self._connect_device)
        self.simulation = simulation
        Operation(node, simulation, settings, None, self.bench).begin()
        self.add("base_driver", self._start_base)
        if any(each.part == "lidar" and each.protocol for each in self.base.drivers):
            self.add("lidar_driver", self._start_lidar)

    def _connect_device(self, path: Path) -> Cable:
        return self.cables.setdefault(str(path), Cable())

    def _start_base(self, node: Node) -> None:
        assert self.base.driver
        driver = self.base.driver
        board = make_board(driver.protocol, self.base)
        connect = self._connect(node, driver.device)
        self.driver = BaseDriver(node, self.base, board, connect, self._report, lambda: self.orphaned)

    def _start_lidar(self, node: Node) -> None:
        assert self.base.lidar
        driver = next(each for each in self.base.drivers if each.part == "lidar")
        LidarDriver(node, self.base.lidar, LIDARS[driver.protocol](), self._connect(node, driver.device), 0.0)

    def _connect(self, node: Node, device: str) -> Callable[[LineUser, LineSettings], DeviceLine]:
        def connect(user: LineUser, settings: LineSettings) -> DeviceLine:
            line = MemoryLine(node, self.cables[device], user, settings)
            self.lines.append(line)
            return line

        return connect

    @property
    def cable(self) -> Cable:
        """That of the board."""
        assert self.base.driver
        return self.cables[self.base.driver.device]

    @property
    def firmware(self) -> Any:
        """That of the board."""
        assert self.base.driver
        return self.bench.firmwares[self.base.driver.device]
