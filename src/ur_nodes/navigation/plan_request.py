"""Requests for global plans, and their answers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ur_nodes.costmap.costmap import FREE, LETHAL, Costmap
from ur_nodes.navigation.navigator_step import PlanAnswer
from ur_nodes.navigation.planning.global_plan import NoPathError, PlanSettings, plan_path


@dataclass(frozen=True, slots=True, eq=False)
class PlanRequest:
    """From where to where (m, in the map), on which costs. `key` names it.

    `static` are the costs of the map and its keep-out zones, `zones` those of the zones alone.
    """

    key: int
    start: tuple[float, float]
    goal: tuple[float, float]
    costmap: Costmap
    static: Costmap
    zones: Costmap | None = None


def answer_request(request: PlanRequest, settings: PlanSettings) -> PlanAnswer:
    """Plan; when there is no path, report whether the map (hopeless) or obstacles (may change) are the reason."""
    try:
        return PlanAnswer(plan_path(request.costmap, request.start, request.goal, settings))
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
