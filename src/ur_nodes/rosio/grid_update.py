"""Updates of grids, for nodes that are still written against rospy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ur.source.diagnostic import UserError, error
from ur_nodes.codecs.genpy.grid_update import GridUpdate as GridUpdate
from ur_nodes.codecs.genpy.grid_update import update_message as update_message


def apply_update(values: NDArray[np.int8], message: GridUpdate) -> None:
    """Write the new values into a grid's `values` (height, width). Raises UserError: they do not fit into the grid."""
    height, width = values.shape
    inside = message.x >= 0 and message.y >= 0 and message.x + message.width <= width
    if not inside or message.y + message.height > height or message.width * message.height != len(message.data):
        raise UserError(
            error(
                f"update of {message.width} x {message.height} cells at ({message.x}, {message.y}) with "
                f"{len(message.data)} values, expected one value per cell, inside the grid of {width} x {height}",
                rule="bad-map",
            )
        )
    rows, columns = slice(message.y, message.y + message.height), slice(message.x, message.x + message.width)
    values[rows, columns] = message.data.reshape(message.height, message.width)
