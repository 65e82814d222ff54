"""An exploration without nodes: a lidar without noise, and a robot that follows the shortest way."""

import math
import time
from dataclasses import dataclass
from statistics import median

import numpy as np
from bench.exploration_parts.truth import Truth
from skimage.graph import MCP_Geometric

from ur_nodes.exploration.explorer import Explorer
from ur_nodes.exploration.explorer_step import ExplorerInputs, ExplorerSettings, GoalEnd
from ur_nodes.exploration.search.floor import nearest_cell
from ur_nodes.exploration.status import ExploreStatus
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import SensorMount
from ur_nodes.slam.matching.scan import make_scan
from ur_nodes.slam.occupancy import OccupancyMap

_STEP = 0.25  # m between two scans
_SPEED = 0.5  # m/s
_LAST = 15.0  # s before the end, in which no estimate of the time left is judged

ENOUGH = 0.98
"""The share of the reachable floor that is to be found."""


@dataclass(frozen=True, slots=True, eq=False)
class Quick:
    """The result: the last status, the map, the way in m, the share of the reachable floor that is known.

    `seconds` of CPU time for the longest decision; `touched`: how often the robot was where it does not fit.
    `most` is the way (m) after which `ENOUGH` of the floor was known, inf: never.
    `off` is the median factor by which the estimates of the time left were off, until 15 s before the end; nan: none.
    """

    status: ExploreStatus
    grid: Grid
    way: float
    share: float
    track: tuple[Pose2, ...]
    seconds: float
    touched: int
    most: float
    off: float


def explore_quickly(truth: Truth, settings: ExplorerSettings, most: int = 2000) -> Quick:
    """Explore until the end, or for so many steps."""
    explorer, drawn = Explorer(settings), OccupancyMap()
    angles = np.arange(360) * (2.0 * math.pi / 360)
    directions = np.column_stack((np.cos(angles), np.sin(angles)))
    robot, way, now = Pose2(0.0, 0.0, 0.0), 0.0, 0.0
    poses, scans = [], []
    goal: Pose2 | None = None
    ended: GoalEnd | None = None
    status, longest, touched, most_at = ExploreStatus(), 0.0, 0, math.inf
    guesses: list[tuple[float, float]] = []  # s: when, and how long it was to take
    floor = truth.grid.points_of_cells(np.argwhere(truth.floor))
    for version in range(most):
        ranges = truth.ranges(robot.x, robot.y, robot.yaw)
        poses.append(robot)
        scans.append(make_scan(ranges, directions, (0.1, 12.0), SensorMount(np.eye(3), np.zeros(3))))
        drawn.update(poses, scans)
        if most_at == math.inf and np.mean(drawn.grid().values_at(floor) >= 0) >= ENOUGH:
            most_at = way
        began = time.process_time()
        out = explorer.step(ExplorerInputs(now, drawn.grid(), version, robot, ended=ended))
        longest = max(longest, time.process_time() - began)
        status, ended = out.status, None
        if status.left is not None:
            guesses.append((now, status.left))
        if status.ended:
            break
        if out.cancel:
            goal = None
        goal = out.goal or goal
        if goal is None:
            now += 1.0
            continue
        moved = _drive(truth, robot, goal)
        now += 1.0 if moved is None else _STEP / _SPEED
        if moved is None:
            near = math.dist(robot[:2], goal[:2]) < 0.3
            ended, goal = GoalEnd(near, "" if near else "no path"), None
        else:
            way += math.dist(robot[:2], moved[:2])
            robot = moved
            touched += int(not truth.fits[tuple(truth.grid.cells_of_points(np.array(robot[:2])))])
    grid = drawn.grid()
    known = grid.values_at(floor) >= 0
    wrong = [abs(math.log(left / (now - at))) for at, left in guesses if now - at > _LAST]
    off = math.exp(median(wrong)) if wrong else math.nan
    return Quick(status, grid, way, float(known.mean()), tuple(poses), longest, touched, most_at, off)


def _drive(truth: Truth, robot: Pose2, goal: Pose2) -> Pose2 | None:
    """A step along the shortest way; None at its end."""
    start = nearest_cell(truth.grid, truth.fits, robot[:2], 0.5)
    end = nearest_cell(truth.grid, truth.fits, goal[:2], 0.25)
    if start is None or end is None or start == end:
        return None
    search = MCP_Geometric(np.where(truth.fits, 1.0, -1.0))
    search.find_costs([start], [end])
    try:
        path = search.traceback(end)
    except ValueError:
        return None
    cell = path[min(len(path) - 1, max(1, round(_STEP / truth.grid.resolution)))]
    x, y = truth.grid.points_of_cells(np.array(cell)).tolist()
    return Pose2(x, y, robot.yaw)
