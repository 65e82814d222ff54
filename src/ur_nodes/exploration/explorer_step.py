"""Inputs and outputs of a step of the explorer, and its settings."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ur_nodes.exploration.search.choice import CornerSettings, Weights
from ur_nodes.exploration.search.frontiers import Frontier
from ur_nodes.exploration.status import ExploreStatus
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2


@dataclass(frozen=True, slots=True)
class ExplorerSettings:
    """Lengths in m, times in s. `radius` of the robot; `room` is the free space that goals have, if possible, to turn.

    `settle`: how long there must be nothing left before the end. `patience`: how long frontiers that failed are waited
    for. `attempts` at a frontier that navigation gave up. `corners`: frontiers that come last, or are left out.
    """

    radius: float
    room: float = 0.25
    smallest_frontier: float = 0.3
    progress_timeout: float = 30.0
    settle: float = 4.0
    patience: float = 15.0
    attempts: int = 2
    weights: Weights = field(default_factory=Weights)
    corners: CornerSettings = field(default_factory=CornerSettings)


@dataclass(frozen=True, slots=True)
class GoalEnd:
    """The end of a goal: reached, or not and why."""

    reached: bool
    text: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class ExplorerInputs:
    """The present state of the world. `version` grows with each map; `obstacles` as `read_floor` takes them.

    `ended`: the goal has ended since the last step; None: it has not. `paused`: why the robot must not be driven.
    """

    now: float
    grid: Grid
    version: int
    robot: Pose2
    obstacles: NDArray[np.floating] | None = None
    ended: GoalEnd | None = None
    paused: str = ""


@dataclass(frozen=True, slots=True)
class ExplorerOutputs:
    """Commands for navigation. `goal`: drive there, in place of what was pursued; `cancel` it; `clear` the costmaps."""

    status: ExploreStatus
    goal: Pose2 | None = None
    cancel: bool = False
    clear: bool = False
    frontiers: tuple[Frontier, ...] = ()
    blocked: tuple[Frontier, ...] = ()
