"""Requests for global plans, and their answers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ur_nodes.costmap.costmap import FREE, LETHAL, Costmap
from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.navigator_step import PlanAnswer
from ur_nodes.navigation.planning.global_plan import NoPathError, PlanSettings, plan_path, traversal_weights
from ur_nodes.navigation.planning.legs import points_of_legs
from ur_nodes.navigation.planning.outline_motions import Steering
from ur_nodes.navigation.planning.outline_plan import fit_outline, is_long


@dataclass(frozen=True, slots=True, eq=False)
class PlanRequest:
    """From where to where (m, in the map), on which costs. `key` names it.

    With `yaw` (rad), the robot's, the path is made for its outline; `heading` (rad) is that at the goal, None: any.
    `careful`: the robot could not follow the path before. `static` are the costs of the map and its keep-out zones,
    `zones` those of the zones alone.
    """

    key: int
    start: tuple[float, float]
    goal: tuple[float, float]
    costmap: Costmap
    static: Costmap
    zones: Costmap | None = None
    yaw: float | None = None
    heading: float | None = None
    careful: bool = False


def answer_request(request: PlanRequest, settings: PlanSettings, footprint: Footprint | None = None) -> PlanAnswer:
    """Plan; when there is no path, report whether the map (hopeless) or obstacles (may change) are the reason.

    The path of a long robot is one that its `footprint` fits on, where such a path was found.
    """
    try:
        path = plan_path(request.costmap, request.start, request.goal, settings)
        if footprint is None or request.yaw is None or not is_long(footprint):
            return PlanAnswer(path)
        start, weights = Pose2(*request.start, request.yaw), traversal_weights(settings)
        fitted = fit_outline(
            request.costmap,
            weights,
            path,
            footprint,
            start,
            request.heading,
            Steering(),
            careful=request.careful,
        )
        return PlanAnswer(points_of_legs(fitted.legs), legs=fitted.legs, last_turn=fitted.last_turn)
    except NoPathError as problem:
        reason = str(problem)
    if request.zones is not None:
        for name, (x, y), help_ in (("goal", request.goal, ""), ("robot at", request.start, "; drive it out by hand")):
            if request.zones.costs_at(np.array((x, y)), outside=FREE) == LETHAL:
                return PlanAnswer(None, f"the {name} ({x:.2f}, {y:.2f}) is in a keep-out zone{help_}", hopeless=True)
    try:
        plan_path(request.static, request.start, request.goal, settings)
    except NoPathError as problem:
        return PlanAnswer(None, str(problem), hopeless="goal" in str(problem))
    return PlanAnswer(None, f"{reason}, because of obstacles that the map does not show")
