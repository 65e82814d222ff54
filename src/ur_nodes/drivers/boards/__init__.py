"""The boards of bases: a module each, bytes in, values out; no I/O and no clock. `BOARDS` has them by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ur.robot.base import Base
from ur.robot.base.wiring import Wiring
from ur_nodes.drivers.boards.arduino import Arduino
from ur_nodes.drivers.boards.board import MotorBoard, RewiredBoard
from ur_nodes.drivers.boards.create2 import Create2
from ur_nodes.drivers.boards.loki import Loki
from ur_nodes.drivers.boards.magni import Magni
from ur_nodes.drivers.boards.neato import Neato
from ur_nodes.drivers.boards.opencr import OpenCr

BOARDS: Mapping[str, Callable[[Base], MotorBoard]] = {
    "arduino": Arduino,
    "create2": Create2,
    "loki": Loki,
    "magni": Magni,
    "neato": Neato,
    "turtlebot3": OpenCr,
}


def make_board(name: str, base: Base) -> MotorBoard:
    """Make a board by its name, with the wiring of the base."""
    board = BOARDS[name](base)
    wiring = base.driver.wiring if base.driver else Wiring()
    return RewiredBoard(board, wiring) if wiring.names else board
