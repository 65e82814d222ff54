"""Inputs and outputs of a step of the explorer, and its settings."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.local_costmap_settings import read_footprint
from ur_nodes.exploration.search.choice import CornerSettings, Weights
from ur_nodes.exploration.search.frontiers import Frontier
from ur_nodes.exploration.status import ExploreStatus
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.parameters import Parameters


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


@dataclass(frozen=True, slots=True)
class ExploreSettings:
    """`period`: s between two decisions. `quiet`: s without another driver before it goes on.

    `save_service` saves the map and answers its name; '' where it is not saved. `navigation` is the node with the
    action, `costmap` the topic of its global costmap, `costmap_updates` that of the cells that changed.
    """

    explorer: ExplorerSettings
    period: float
    quiet: float
    base_frame: str
    map_frame: str
    navigation: str
    costmap: str
    costmap_updates: str
    mux: str
    save_service: str


def read_settings(own: Parameters) -> ExploreSettings:
    """Read them all. Raises UserError, which names the parameter."""
    navigation = own.text("navigation", "move_base")
    footprint = read_footprint(own.of(navigation).below("global_costmap"), 0.05)
    return ExploreSettings(
        explorer=ExplorerSettings(
            radius=footprint.inscribed,
            room=footprint.circumscribed,
            smallest_frontier=own.number("min_frontier_size", 0.3, minimum=0.05, maximum=10.0, live="least width, m"),
            progress_timeout=own.number("progress_timeout", 30.0, minimum=1.0, maximum=3600.0, live="s until failure"),
            patience=own.number("patience", 15.0, minimum=0.0, maximum=3600.0, live="s without goals until the end"),
            corners=CornerSettings() if not own.boolean("explore_corners", False) else CornerSettings(left_out=0.0),
            weights=Weights(
                distance=own.number("potential_scale", 1.0, minimum=0.0, maximum=1e3, live="weight of the way"),
                gain=own.number("gain_scale", 0.1, minimum=0.0, maximum=1e3, live="weight of a frontier's width"),
            ),
        ),
        period=1.0 / own.number("planner_frequency", 1.0, minimum=0.05, maximum=10.0, live="rate of decisions, Hz"),
        quiet=own.number("resume_after", 5.0, minimum=0.0, maximum=3600.0),
        base_frame=own.text("robot_base_frame", "base_footprint"),
        map_frame=own.text("global_frame", "map"),
        navigation=navigation,
        costmap=own.text("costmap_topic", f"{navigation}/global_costmap/costmap"),
        costmap_updates=own.text("costmap_updates_topic", f"{navigation}/global_costmap/costmap_updates"),
        mux=own.text("mux", "cmd_vel_mux"),
        save_service=own.text("save_service", ""),
    )
