"""A board during the test of its wheels: handshake, commands and readings over a line. No clock and no terminal."""

import math
from typing import Protocol

from ur.robot.base import Base
from ur.source.diagnostic import UserError, error
from ur_nodes.drivers.boards.board import MotorBoard
from ur_nodes.drivers.readings import Counts, DeviceIdentity, Motors
from ur_nodes.drivers.wheels.verdict import DISTANCE, SPEED, WheelMotion

_ANSWER = 6.0  # s in which a board has to report counts
_SETTLE = 1.0  # s in which it reports what holds it
_AGAIN = 1.0  # s after which it gets the handshake again
_REST = 0.8  # s after a motion in which wheels come to rest


class TimedLine(Protocol):
    """An open line to a board."""

    name: str
    """The device file, for messages."""

    def time(self) -> float:
        """The time in s, from any zero."""

    def exchange(self, data: bytes, seconds: float, *, moving: bool) -> bytes:
        """Send bytes, and return what arrives within a time. Raises UserError when the device was unplugged."""


class WheelSession:
    """A board at rest, except while `turn` runs."""

    def __init__(self, line: TimedLine, board: MotorBoard, base: Base) -> None:
        self._line, self._board = line, board
        self._metres = 2.0 * math.pi * base.wheels.radius / board.counts_per_turn
        self._counts: Counts | None = None
        self._rolled = [0, 0]
        self.firmware = self._problem = self._held = ""

    def wait(self) -> None:
        """Greet the board until it counts and obeys. Raises UserError: it does not, in time."""
        period = self._board.period
        for beat in range(round(_ANSWER / period)):
            if beat % round(_AGAIN / period) == 0:
                self._take(self._line.exchange(self._board.stop() + self._board.handshake(), 0.0, moving=False))
            self._beat(0.0, 0.0)
            if beat * period > _SETTLE and self._counts and not self._held and not self._problem:
                return
        where = f"{self._line.name}: "
        if self._problem or self._held:
            text = f"{where}{self._board.name} does not drive: {self._problem or self._held}"
            raise UserError(error(text, rule="no-device", help="set that right, and run this again"))
        text = f"{where}no wheel counts of {self._board.name} for {_ANSWER:g} s; is it switched on?"
        raise UserError(error(text, rule="no-device", help="see what is there: ur devices"))

    def turn(self, motion: WheelMotion) -> tuple[float, float]:
        """Have the wheels roll DISTANCE; return what the board's left and right counter show (m). Raises UserError."""
        self._rolled = [0, 0]
        for seconds, speed in ((DISTANCE / SPEED, SPEED), (_REST, 0.0)):
            end = self._line.time() + seconds - self._board.period / 2.0
            while self._line.time() < end:
                self._beat(motion.signs[0] * speed, motion.signs[1] * speed)
        return self._rolled[0] * self._metres, self._rolled[1] * self._metres

    def _beat(self, left: float, right: float) -> None:
        """Send speeds, and read for a period."""
        moving = left != 0.0 or right != 0.0
        self._take(self._line.exchange(self._board.drive(left, right), self._board.period, moving=moving))

    def _take(self, data: bytes) -> None:
        for reading in self._board.receive(data):
            if isinstance(reading, Counts):
                before, self._counts = self._counts or reading, reading
                half = 1 << (reading.bits - 1)
                self._rolled[0] += (reading.left - before.left + half) % (2 * half) - half
                self._rolled[1] += (reading.right - before.right + half) % (2 * half) - half
            elif isinstance(reading, Motors):
                self._held = "" if reading.ready else reading.reason
            elif isinstance(reading, DeviceIdentity):
                self._problem = self._problem or reading.problem
                self.firmware = self.firmware or reading.text
