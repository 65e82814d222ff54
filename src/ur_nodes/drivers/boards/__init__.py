"""The boards of bases: a module each, bytes in, values out; no I/O and no clock. `BOARDS` has them by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ur.robot.base import Base
from ur_nodes.drivers.boards.arduino import Arduino
from ur_nodes.drivers.boards.board import MotorBoard
from ur_nodes.drivers.boards.create2 import Create2
from ur_nodes.drivers.boards.magni import Magni
from ur_nodes.drivers.boards.neato import Neato

BOARDS: Mapping[str, Callable[[Base], MotorBoard]] = {
    "arduino": Arduino,
    "create2": Create2,
    "magni": Magni,
    "neato": Neato,
}
