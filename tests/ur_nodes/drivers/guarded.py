"""A board's stand-in without a watchdog, at the end of the real line of a driver in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.ur_nodes.drivers.mutations import StillPlant

from ur.run.host.cgroup import Cgroup
from ur_nodes.drivers.boards import arduino, magni
from ur_nodes.drivers.registry import FIRMWARES
from ur_nodes.simulator.devices.bench import DeviceTerminal

LONGEST = 30.0  # s
# Greets the board and sends it speeds, as BaseDriver does.
PROGRAM = """
import sys, time
from tests.base_contract import load
from tests.ur_nodes.drivers.threads import ThreadedNode
from ur_nodes.drivers.registry import BOARDS
from ur_nodes.drivers.lines.line import LineSettings, LineUser
from ur_nodes.drivers.lines.serial_line import SerialLine
board = BOARDS[sys.argv[1]](load("create2", ""))
user = LineUser(lambda: None, lambda data, stamp: None, lambda reason: None)
line = SerialLine(ThreadedNode(), sys.argv[2], user, LineSettings(board.baud, board.stop(), shutdown=board.shutdown()))
for _ in range(50):
    line.write(board.handshake())
    time.sleep(0.01)
while True:
    line.write(board.drive(0.2, 0.2), moving=True)
    time.sleep(board.period)
"""


class GuardedBoard(StillPlant):
    """A context: the driver runs in it. `turned` are the speeds that the motors got, m/s; `group` gets the driver."""

    def __init__(self, name: str, path: Path, group: Cgroup | None = None) -> None:
        super().__init__()
        self.turned: list[tuple[float, float]] = [(0.0, 0.0)]
        self.firmware: Any = FIRMWARES[name](self)  # type: ignore[arg-type]
        self._terminal = DeviceTerminal(path)
        self._join = (lambda: group.add(os.getpid())) if group else None
        self._watchdogs = arduino.WATCHDOG, magni.CLOCK
        self._command = [sys.executable, "-c", PROGRAM, name, str(path)]

    def __enter__(self) -> GuardedBoard:
        arduino.WATCHDOG, magni.CLOCK = 1e9, 1.0
        self.driver = subprocess.Popen(self._command, start_new_session=True, preexec_fn=self._join)
        return self

    def __exit__(self, *_: object) -> None:
        arduino.WATCHDOG, magni.CLOCK = self._watchdogs
        self.driver.kill()
        self.driver.wait()
        self._terminal.close()

    def turn_wheels(self, left: float, right: float) -> None:
        self.turned.append((left, right))

    @property
    def rests(self) -> bool:
        """The last speeds were 0; 1 mm/s for a second is a Neato's."""
        return max(map(abs, self.turned[-1])) <= 0.001

    def run_until(self, condition: Callable[[], bool]) -> None:
        """Have the stand-in obey and report until a condition holds."""
        end = time.monotonic() + LONGEST
        while not condition():
            assert time.monotonic() < end, self.turned[-5:]
            self._terminal.write(self.firmware.receive(self._terminal.read()))
            time.sleep(0.002)
