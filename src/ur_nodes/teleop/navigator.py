"""What the navigation programs see of a robot: a picture of it, and six things to ask of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ur_nodes.rosio.pose import Pose2
from ur_nodes.teleop.emergency import MuxView, Wish

Place = Pose2
"""A pose in the map frame: m, m, rad."""


@dataclass(frozen=True, eq=False)
class MapGrid:
    """An occupancy grid. `cells` is (height, width) int8, row 0 at the origin: 0 free to 100 occupied, -1 unknown.

    `resolution` is in m per cell; `origin` is the pose of the corner of cell (0, 0) in the map frame.
    """

    cells: NDArray[np.int8]
    resolution: float
    origin: Place

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The box that holds it: left, bottom, right, top in m."""
        height, width = self.cells.shape
        c, s = math.cos(self.origin.yaw), math.sin(self.origin.yaw)
        corners = [(x * self.resolution, y * self.resolution) for x in (0, width) for y in (0, height)]
        xs = [self.origin.x + c * x - s * y for x, y in corners]
        ys = [self.origin.y + s * x + c * y for x, y in corners]
        return min(xs), min(ys), max(xs), max(ys)


class GoalState(Enum):
    """Where the last goal stands; the value is what people read."""

    NONE = "no goal"
    WAITING = "sent"
    DRIVING = "driving"
    REACHED = "reached"
    STOPPED = "stopped"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class GoalReport:
    """The last goal, its number (0: none was sent yet), how it stands, and why when it failed."""

    number: int = 0
    place: Place | None = None
    state: GoalState = GoalState.NONE
    text: str = ""

    @property
    def over(self) -> bool:
        """Whether nothing more will happen to it."""
        return self.state not in (GoalState.WAITING, GoalState.DRIVING)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """All that is known at one moment, in the map frame; None for what is not known.

    `scan` and `path` are (n, 2) in m; `speed` m/s and `turn` rad/s; `spread` the localiser's standard deviation in m;
    `missing` names what is waited for, in words for people.
    """

    grid: MapGrid | None = None
    pose: Place | None = None
    scan: NDArray[np.float64] | None = None
    path: NDArray[np.float64] | None = None
    goal: GoalReport = field(default_factory=GoalReport)
    speed: float = 0.0
    turn: float = 0.0
    spread: float | None = None
    missing: tuple[str, ...] = ()
    mux: MuxView = field(default_factory=MuxView)


class Navigator(Protocol):
    """A robot that can be sent to places. No call blocks; what came of it is in later snapshots."""

    def snapshot(self) -> Snapshot:
        """What is known now."""

    def go(self, place: Place) -> int:
        """Drive there, instead of where it drove so far. Returns the goal's number in `GoalReport`."""

    def stop(self) -> None:
        """Give up the goal, whoever sent it."""

    def ask_mux(self, wish: Wish) -> None:
        """Stop everything that drives, whoever does, or let it drive again."""

    def set_pose(self, place: Place) -> None:
        """Tell the localiser that the robot is here."""

    def relocalise(self) -> None:
        """Have the localiser look for the robot everywhere. Raises UserError when it does not offer that."""


def distance_left(snapshot: Snapshot) -> float | None:
    """Along the path from the robot to the goal, in m; the straight line when there is no path to this goal."""
    goal, pose, path = snapshot.goal.place, snapshot.pose, snapshot.path
    if goal is None or pose is None:
        return None
    here = np.array([pose.x, pose.y])
    straight = math.hypot(goal.x - pose.x, goal.y - pose.y)
    if path is None or len(path) < 2 or math.hypot(path[-1, 0] - goal.x, path[-1, 1] - goal.y) > 0.5:
        return straight
    nearest = int(np.argmin(np.sum((path - here) ** 2, axis=1)))
    rest = path[nearest:]
    return float(np.sum(np.hypot(*np.diff(rest, axis=0).T))) if len(rest) > 1 else straight


def heading_there(snapshot: Snapshot, x: float, y: float) -> float:
    """The yaw to arrive with when none was given: the way from here to there."""
    pose = snapshot.pose
    if pose is None or math.hypot(x - pose.x, y - pose.y) < 0.05:
        return pose.yaw if pose else 0.0
    return math.atan2(y - pose.y, x - pose.x)


def angle_between(one: float, other: float) -> float:
    """The angle from one direction to another without its sign, in rad from 0 to pi."""
    return abs((one - other + math.pi) % (2.0 * math.pi) - math.pi)
