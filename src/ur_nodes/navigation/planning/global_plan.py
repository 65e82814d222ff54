"""The path to a goal on the inflated grid: a search of the cheapest cells, then straightened and smoothed."""

import math
from dataclasses import dataclass, field

import numpy as np

from ur_nodes.costmap.costmap import INSCRIBED, LETHAL, UNKNOWN, Costmap
from ur_nodes.navigation.planning.grid_search import find_cell_path
from ur_nodes.navigation.planning.path_geometry import Points, resample
from ur_nodes.navigation.planning.path_smooth import Bending, Weights, pull_straight, smooth


@dataclass(frozen=True, slots=True)
class PlanSettings:
    """Parameters of planning. A cell of cost c (0 to 252) costs neutral + factor c per metre, as in navfn.

    `allow_unknown`: the path may lead through unknown cells. `tolerance`: distance from the goal at which the path may
    end when the goal itself cannot be reached (m). `nudge`: how far it may end from a goal where obstacles are nearer
    than `room`, to gain room to turn (m). `escape`: distance of a free cell from the robot when the robot is too near
    to an obstacle (m). `spacing`: distance of the points of a path (m).
    """

    neutral: float = 50.0
    factor: float = 0.3
    allow_unknown: bool = False
    tolerance: float = 0.0
    nudge: float = 0.05
    room: float = 0.0
    escape: float = 0.4
    spacing: float = 0.05
    bending: Bending = field(default_factory=Bending)


class NoPathError(Exception):
    """No path exists. The text is a clause for users with the reason and the place."""


def plan_path(
    costmap: Costmap, start: tuple[float, float], goal: tuple[float, float], settings: PlanSettings
) -> Points:
    """Plan a smooth path (n, 2) in m, evenly spaced, from `start` to `goal` (both in the costmap's frame).

    No point of it has a cost of 253 or more, except where the start itself has. Deterministic.
    Raises NoPathError: a place outside the map, in an obstacle, too near to one, or not connected.
    """
    weights = traversal_weights(settings)
    start_cell = _start_cell(costmap, weights, start, settings)
    goal_cell, target = _goal_cell(costmap, weights, goal, settings)
    cells = find_cell_path(costmap.costs, weights, start_cell, goal_cell)
    if cells is None:
        raise NoPathError(
            f"no path: nothing wide enough for the robot leads from {_place(start)} to the goal {_place(goal)}"
        )
    points: Points = costmap.points_of_cells(cells)
    points[-1] = target
    escape = np.array([start]) if weights[costmap.costs[_cell(costmap, start)]] == math.inf else np.empty((0, 2))
    if not len(escape):
        points[0] = start
    keep = np.hypot(*np.diff(points, axis=0, prepend=points[:1] - 1.0).T) > 1e-9  # no point twice
    points = points[keep] if keep.sum() > 1 else points[[0, -1]]
    straight = pull_straight(points, costmap, weights)
    straight = pull_straight(resample(straight, 2.0 * settings.spacing), costmap, weights)
    smoothed = smooth(straight, costmap, weights, settings.bending)
    whole: Points = np.vstack((escape, smoothed))
    return resample(whole, settings.spacing)


def traversal_weights(settings: PlanSettings) -> Weights:
    """Return the cost of a metre for each cost of a cell (256), 1 for a cost of 0; inf where the robot must not go."""
    weights = 1.0 + settings.factor * np.arange(256.0) / settings.neutral
    weights[INSCRIBED:] = math.inf
    if settings.allow_unknown:
        weights[UNKNOWN] = 1.0 + settings.factor * (INSCRIBED - 1) / settings.neutral
    return weights


def path_is_free(costmap: Costmap, points: Points) -> bool:
    """Return True when the robot's circle fits everywhere on a path: no cost of 253 or 254."""
    costs = costmap.costs_at(points)
    return not bool(((costs == INSCRIBED) | (costs == LETHAL)).any())


def _start_cell(
    costmap: Costmap, weights: Weights, start: tuple[float, float], settings: PlanSettings
) -> tuple[int, int]:
    cell = _cell(costmap, start)
    if not _inside(costmap, cell):
        raise NoPathError(f"the robot at {_place(start)} is outside the map")
    if math.isfinite(weights[costmap.costs[cell]]):
        return cell
    near = _nearest_free(costmap, weights, start, settings.escape)
    if near is None:
        what = _obstacle(costmap, cell)
        raise NoPathError(f"the robot at {_place(start)} is {what}, and no free place is within {settings.escape:g} m")
    return near


def _goal_cell(
    costmap: Costmap, weights: Weights, goal: tuple[float, float], settings: PlanSettings
) -> tuple[tuple[int, int], tuple[float, float]]:
    cell = _cell(costmap, goal)
    if not _inside(costmap, cell):
        raise NoPathError(f"the goal {_place(goal)} is outside the map")
    if math.isfinite(weights[costmap.costs[cell]]):
        return _with_room(costmap, weights, cell, goal, settings)
    near = _nearest_free(costmap, weights, goal, settings.tolerance) if settings.tolerance > 0.0 else None
    if near is None:
        raise NoPathError(f"the goal {_place(goal)} is {_obstacle(costmap, cell)}")
    x, y = costmap.points_of_cells(np.array(near))
    return near, (float(x), float(y))


def _with_room(
    costmap: Costmap, weights: Weights, cell: tuple[int, int], goal: tuple[float, float], settings: PlanSettings
) -> tuple[tuple[int, int], tuple[float, float]]:
    """The goal, or a place at most `nudge` from it with more room, where the goal has less than `room`."""
    around = math.ceil((settings.room + settings.nudge) / costmap.resolution) + 1
    rows = slice(max(0, cell[0] - around), cell[0] + around + 1)
    columns = slice(max(0, cell[1] - around), cell[1] + around + 1)
    walls = costmap.points_of_cells(
        np.argwhere(costmap.costs[rows, columns] == LETHAL) + np.array((rows.start, columns.start))
    )
    if not len(walls):
        return cell, goal
    steps = np.linspace(-settings.nudge, settings.nudge, 9)
    offsets = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    offsets = offsets[np.hypot(*offsets.T) <= settings.nudge + 1e-9]
    places = np.array(goal) + offsets[np.argsort(np.hypot(*offsets.T), kind="stable")]
    rooms = np.sqrt(((places[:, None] - walls) ** 2).sum(axis=2)).min(axis=1)
    # The nearest that has enough; else the one with the most.
    best = int(np.argmax(rooms >= settings.room)) if (rooms >= settings.room).any() else int(np.argmax(rooms))
    x, y = places[best].tolist()
    target = _cell(costmap, (x, y))
    if not _inside(costmap, target) or not math.isfinite(weights[costmap.costs[target]]):
        return cell, goal
    return target, (x, y)


def _obstacle(costmap: Costmap, cell: tuple[int, int]) -> str:
    cost = int(costmap.costs[cell])
    if cost == LETHAL:
        return "in a wall or an obstacle"
    return "in unknown space" if cost == UNKNOWN else "so near to a wall or an obstacle that the robot does not fit"


def _nearest_free(
    costmap: Costmap, weights: Weights, point: tuple[float, float], reach: float
) -> tuple[int, int] | None:
    row, column = _cell(costmap, point)
    steps = math.ceil(reach / costmap.resolution)
    rows = slice(max(0, row - steps), row + steps + 1)
    columns = slice(max(0, column - steps), column + steps + 1)
    free = np.argwhere(np.isfinite(weights[costmap.costs[rows, columns]])) + np.array((rows.start, columns.start))
    if not len(free):
        return None
    distances = np.hypot(*(costmap.points_of_cells(free) - point).T)
    best = int(np.argmin(distances))
    return (int(free[best, 0]), int(free[best, 1])) if float(distances[best]) <= reach else None


def _cell(costmap: Costmap, point: tuple[float, float]) -> tuple[int, int]:
    row, column = np.floor(costmap.fractions_of_points(np.array(point)))
    return int(row), int(column)


def _inside(costmap: Costmap, cell: tuple[int, int]) -> bool:
    height, width = costmap.costs.shape
    return bool(0 <= cell[0] < height and 0 <= cell[1] < width)


def _place(point: tuple[float, float]) -> str:
    return f"({point[0]:.2f}, {point[1]:.2f})"
