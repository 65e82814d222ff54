"""A stand-in board on a pseudo-terminal in this process, whose clock runs while the program of the wheels reads it."""

import os
import select
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.ur_nodes.drivers.pipes import open_pipe, read_rest
from tests.ur_nodes.drivers.wheels.lifted import TICK, LiftedPlant

from ur.robot.base.wiring import Wiring
from ur_nodes.drivers.registry import BOARDS, FIRMWARES
from ur_nodes.simulator.devices.bench import DeviceTerminal

PROGRAM = "ur_nodes.drivers.wheels.program"
_PATIENCE = 20.0  # s


class WiredBoard:
    """A board of a kind, at `path`, with a guard that records in place of a process.

    Its time passes by a period for each message that it receives, so that no test waits for it. `silent` boards answer
    nothing; one that is `unplugged_by_motion` is unplugged once a wheel turns, and one that `kills_guard_by_motion` has
    its guard killed then, once.
    """

    def __init__(self, path: Path, patch: pytest.MonkeyPatch, board: str = "create2", wiring: Wiring | None = None):
        self.path, self.plant = path, LiftedPlant(wiring or Wiring())
        self.firmware: Any = FIRMWARES[board](self.plant)  # type: ignore[arg-type]
        self.silent = self.unplugged_by_motion = self.kills_guard_by_motion = False
        self.received = b""
        self.guards: list[tuple[bytes, bytes]] = []
        self._period: float = BOARDS[board](self.plant.base).period
        self._terminal: DeviceTerminal | None = DeviceTerminal(path)
        self._pipes: list[int] = []
        patch.setattr(f"{PROGRAM}.time", SimpleNamespace(monotonic=self.monotonic))
        patch.setattr(f"{PROGRAM}.start_guard", self._start_guard)

    def monotonic(self) -> float:
        """Let the board work on what it received; return its time."""
        data = self._terminal.read() if self._terminal else b""
        if data:
            self._take(data)
        return self.plant.time

    def unplug(self) -> None:
        """Take the device away."""
        if self._terminal:
            terminal, self._terminal = self._terminal, None
            terminal.close()

    def close(self) -> None:
        self.unplug()
        for pipe in self._pipes:
            os.close(pipe)

    def receives(self, end: bytes) -> bool:
        """Wait until the last bytes that the device received are these."""
        assert self._terminal
        while not self.received.endswith(end) and select.select([self._terminal._ours], [], [], _PATIENCE)[0]:
            self.received += self._terminal.read()
        return self.received.endswith(end)

    def guard_bytes(self) -> bytes:
        """What the guard was told, and that its pipe was closed. Raises BlockingIOError: it is open."""
        (pipe,) = self._pipes
        return read_rest(pipe)

    def _start_guard(self, _device: int, stop: bytes, shutdown: bytes) -> tuple[int, int]:
        theirs, ours = open_pipe()
        self._pipes.append(theirs)
        self.guards.append((stop, shutdown))
        return ours, 0

    def _take(self, data: bytes) -> None:
        assert self._terminal
        self.received += data
        answer = self.firmware.receive(data)
        for _ in range(round(self._period / TICK)):
            self.plant.advance(TICK)
            answer += self.firmware.tick()
        if self.kills_guard_by_motion and self.plant.last != (0, 0):
            self.kills_guard_by_motion = False
            os.close(self._pipes.pop())
        if self.unplugged_by_motion and self.plant.last != (0, 0):
            self.unplug()
        elif not self.silent:
            self._terminal.write(answer)
