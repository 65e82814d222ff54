"""A board whose wheels are wired otherwise than it expects, as the base file says."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ur.robot.base.wiring import Wiring
from ur_nodes.drivers.boards.board import MotorBoard
from ur_nodes.drivers.readings import Counts, Reading


class RewiredBoard:
    """See MotorBoard: another board, with the left wheel's speed and counts where the left wheel is."""

    def __init__(self, board: MotorBoard, wiring: Wiring) -> None:
        self._board, self._wiring = board, wiring
        self.name, self.baud, self.period = board.name, board.baud, board.period
        self.counts_per_turn = board.counts_per_turn
        self.greet, self.stop, self.leave = board.greet, board.stop, board.leave

    @property
    def rejected(self) -> int:
        return self._board.rejected

    def drive(self, left: float, right: float) -> bytes:
        return self._board.drive(*self._wiring.command(left, right))

    def take(self, data: bytes) -> Iterator[Reading]:
        for reading in self._board.take(data):
            if isinstance(reading, Counts):
                left, right = self._wiring.counted(reading.left, reading.right)
                yield replace(reading, left=left, right=right)
            else:
                yield reading
