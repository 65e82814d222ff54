"""Reasons why a frontier cannot be reached, with the place that blocks the way."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from skimage.graph import MCP_Geometric

from ur_nodes.exploration.search.floor import Floor
from ur_nodes.exploration.search.frontiers import Frontier

Kind = Literal["narrow", "obstacle", "behind", "apart", "unseen", "failed"]

_THROUGH_UNKNOWN = 30.0  # the cost of a cell, against 1 for a free one
_THROUGH_OBSTACLE = 1000.0


@dataclass(frozen=True, slots=True)
class Reason:
    """The kind of a reason, the place (m) that blocks the way, and a clause for people."""

    kind: Kind
    point: tuple[float, float]
    text: str


def explain_unreachable(floor: Floor, frontier: Frontier, map_walls: np.ndarray | None = None) -> Reason:
    """Explain why the robot can reach no place that sees a frontier.

    `map_walls` (height, width): the occupied cells of the map alone; other occupied ones are obstacles that sensors see
    now.
    """
    narrow = 1.0 / np.maximum(floor.clearance, 0.5 * floor.resolution)
    tight = np.where(floor.clearance > floor.radius, 1.0, 1.0 + narrow**2)
    costs = np.where(floor.free, tight, np.where(floor.unknown, _THROUGH_UNKNOWN, _THROUGH_OBSTACLE))
    goals = np.argwhere(floor.reachable)
    if not len(goals):
        return Reason("apart", frontier.point, "the robot does not know how to get out of its place")
    search = MCP_Geometric(costs)
    totals, _ = search.find_costs([tuple(cell) for cell in frontier.cells.tolist()], find_all_ends=False)
    ways = totals[goals[:, 0], goals[:, 1]]
    path = np.array(search.traceback(tuple(goals[int(np.argmin(ways))].tolist())))
    path = path[::-1]  # from the robot's side
    rows, columns = path[:, 0], path[:, 1]
    crossed = floor.occupied[rows, columns]
    if crossed.any():
        place = floor.point(tuple(path[int(np.argmax(crossed))].tolist()))
        if map_walls is not None and not map_walls[rows, columns][crossed].any():
            return Reason("obstacle", place, f"behind an obstacle at {at(place)}")
        return Reason("behind", place, f"behind the glass or through a gap at {at(place)}")
    room = np.where(floor.unknown[rows, columns], np.inf, floor.clearance[rows, columns])
    tightest = int(np.argmin(room))
    place = floor.point(tuple(path[tightest].tolist()))
    # From the centre of one wall's cell to that of the other; half of either cell belongs to the wall.
    width = max(0.0, 2.0 * float(room[tightest]) - floor.resolution)
    if room[tightest] <= floor.radius:
        return Reason("narrow", place, f"too narrow at {at(place)}: {width:.2f} m < {2.0 * floor.radius:.2f} m")
    if floor.unknown[rows, columns].any():
        return Reason("apart", frontier.point, "no known floor leads to it")
    return Reason("unseen", frontier.point, "no place that the robot gets to is in sight of it")


def at(point: tuple[float, float]) -> str:
    """Describe a place of the map in words for users."""
    return f"({point[0]:.2f}, {point[1]:.2f})"
