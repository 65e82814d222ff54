"""Maps drawn with characters, for the tests of exploration."""

import numpy as np

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

SIDE = 0.4  # m of a character
_CELLS = 8
_VALUES = {"#": 100, ".": 0, "?": -1}

ROOM = """
??????????????
?########?????
?#......#?????
?#......#?????
?#...........?
?#...........?
?#......#?????
?#......#?????
?########?????
??????????????
"""
"""A room with a door of 0.8 m to the right, whose other side is unknown."""


def draw(text: str) -> Grid:
    """Each character is 0.4 m square: `#` wall, `.` floor, `?` unknown. The lower left corner is the origin."""
    rows = text.strip("\n").splitlines()
    values = np.array([[_VALUES[char] for char in row] for row in reversed(rows)], np.int8)
    return Grid(values.repeat(_CELLS, 0).repeat(_CELLS, 1), SIDE / _CELLS, Pose2(0.0, 0.0, 0.0))


def place(column: float, row: float, text: str = ROOM) -> Pose2:
    """The middle of a character; rows count from the top."""
    rows = text.strip("\n").count("\n") + 1
    return Pose2((column + 0.5) * SIDE, (rows - row - 0.5) * SIDE, 0.0)


def box(left: float, low: float, right: float, high: float) -> np.ndarray:
    """Obstacles (n, 2) in m that fill a box."""
    x, y = np.meshgrid(np.arange(left, right, 0.05), np.arange(low, high, 0.05))
    return np.column_stack((x.ravel(), y.ravel()))
