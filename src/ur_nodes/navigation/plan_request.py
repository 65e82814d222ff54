"""Requests for global plans, and their answers."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.costmap import FREE, INSCRIBED, LETHAL, Costmap
from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.navigator_step import PlanAnswer
from ur_nodes.navigation.people.tracked_people import MARGIN, NO_PEOPLE, TrackedPeople
from ur_nodes.navigation.planning.blended_turns import blend_turns
from ur_nodes.navigation.planning.global_plan import NoPathError, PlanSettings, plan_path, traversal_weights
from ur_nodes.navigation.planning.legs import points_of_legs
from ur_nodes.navigation.planning.outline_motions import SPINS, Steering
from ur_nodes.navigation.planning.outline_plan import OutlineRequest, fit_outline, is_long
from ur_nodes.navigation.planning.path_geometry import Points, arc_lengths, resample

_DETOUR, _DETOUR_SPEED = 1.0, 0.5  # m longer, and as much for each second that the robot has waited (m/s)
_TURNED = 0.5  # m: as long as turning by a radian before the path takes
_ROOM, _AMPLE = 0.05, 0.15  # m more than what the local planner keeps; ample: the robot need not slow down
_BEND = 1.0  # m longer, for ample room
_BEGIN = 6  # points of a path that show where it leads at first


@dataclass(frozen=True, slots=True, eq=False)
class PlanRequest:
    """Start and goal (m, in the map), and the costs. `key` identifies the request.

    With `yaw` (rad), the robot's, the path is made for its outline; `heading` (rad) is that at the goal, None: any.
    `careful`: the robot could not follow the path before. `static` are the costs of the map and its keep-out zones,
    `zones` those of the zones alone. The path leads round `people` (in the map) who stand, unless
    that is much longer: they leave sooner or later. `waited` is how long the robot has waited for them, s. `untouched`
    gives the costs without what the robot has touched.
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
    people: TrackedPeople = NO_PEOPLE
    waited: float = 0.0
    untouched: Callable[[], Costmap] | None = None


def answer_request(
    request: PlanRequest, settings: PlanSettings, footprint: Footprint | None = None, steering: Steering = SPINS
) -> PlanAnswer:
    """Plan; when there is no path, report whether the map (hopeless) or obstacles (may change) are the reason.

    The path of a long robot is one that its `footprint` fits on, where such a path was found; that of a robot that
    cannot turn on the spot is always one that it can drive.
    """
    try:
        path = _plan_round_people(request, settings, footprint)
        if footprint is None or request.yaw is None or (steering.spins and not is_long(footprint)):
            if request.yaw is not None and steering.bend:
                weights = traversal_weights(settings)
                path = blend_turns(
                    path, request.yaw, request.heading, steering.bend, settings.room, request.costmap, weights
                )
                path = resample(path, settings.spacing)
            return PlanAnswer(path)
        start, weights = Pose2(*request.start, request.yaw), traversal_weights(settings)
        wanted = OutlineRequest(
            request.costmap, weights, path, footprint, start, request.heading, steering, request.careful
        )
        fitted = fit_outline(wanted)
        if not fitted.legs:
            return PlanAnswer(None, f"no path that a robot with bends of {steering.radius:g} m can drive was found")
        return PlanAnswer(points_of_legs(fitted.legs), legs=fitted.legs, last_turn=fitted.last_turn)
    except NoPathError as problem:
        reason = str(problem)
    if request.zones is not None:
        for name, (x, y), help_ in (("goal", request.goal, ""), ("robot at", request.start, "; drive it out by hand")):
            if request.zones.costs_at(np.array((x, y)), outside=FREE) == LETHAL:
                return PlanAnswer(None, f"the {name} ({x:.2f}, {y:.2f}) is in a keep-out zone{help_}", hopeless=True)
    if request.untouched is not None and _leads_to_goal(request.untouched(), request, settings):
        return PlanAnswer(None, "what the robot touched and its lidar does not see blocks the only way", hopeless=True)
    try:
        plan_path(request.static, request.start, request.goal, settings)
    except NoPathError as problem:
        return PlanAnswer(None, str(problem), hopeless="goal" in str(problem))
    return PlanAnswer(None, f"{reason}, because of obstacles that the map does not show")


def _leads_to_goal(costs: Costmap, request: PlanRequest, settings: PlanSettings) -> bool:
    try:
        plan_path(costs, request.start, request.goal, settings)
    except NoPathError:
        return False
    return True


def _plan_round_people(request: PlanRequest, settings: PlanSettings, footprint: Footprint | None) -> Points:
    """Plan with clearance to standing people, or without it if there is no such path. Raises NoPathError."""
    standing = request.people.standing
    plan = partial(plan_path, start=request.start, goal=request.goal, settings=settings)
    try:
        straight = plan(request.costmap)
    except NoPathError:
        if footprint is None or not len(standing.points):
            raise
        return plan(_without_people(request, standing.points, standing.radii + footprint.inscribed))
    if footprint is None or not len(standing.points):
        return straight
    length = _effort(straight, request.yaw)
    detour = _DETOUR + _DETOUR_SPEED * request.waited
    for room, longest in ((_AMPLE, length + _BEND), (_ROOM, length + detour)):
        radii = standing.radii + MARGIN + room + footprint.inscribed
        try:
            round_them = plan(_with_people(request, standing.points, radii))
        except NoPathError:
            continue
        if _effort(round_them, request.yaw) <= longest:
            return round_them
    return straight


def _effort(path: Points, yaw: float | None) -> float:
    """Return the length of a path in m, longer for a robot that has to turn at its begin."""
    dx, dy = (path[min(_BEGIN, len(path) - 1)] - path[0]).tolist()
    turn = 0.0 if yaw is None else abs(wrap_angle(math.atan2(dy, dx) - yaw))
    return float(arc_lengths(path)[-1]) + _TURNED * turn


def _with_people(request: PlanRequest, places: NDArray[np.float64], radii: NDArray[np.float64]) -> Costmap:
    """Return costs with discs around people for the robot's centre; its position and the goal are left out."""
    costmap = request.costmap
    ends = np.array((request.start, request.goal))
    away = np.hypot(*np.moveaxis(places[:, None] - ends, -1, 0)).min(axis=1) - costmap.resolution
    inside = _in_discs(costmap, places, np.minimum(radii, away)) & (costmap.costs != LETHAL)
    return Costmap(np.where(inside, np.uint8(INSCRIBED), costmap.costs), costmap.resolution, costmap.origin)


def _without_people(request: PlanRequest, places: NDArray[np.float64], radii: NDArray[np.float64]) -> Costmap:
    """Return costs without obstacles where people stand: they leave sooner or later."""
    costmap = request.costmap
    inside = _in_discs(costmap, places, radii + 2.0 * costmap.resolution)
    return Costmap(np.where(inside, request.static.costs, costmap.costs), costmap.resolution, costmap.origin)


def _in_discs(costmap: Costmap, places: NDArray[np.float64], radii: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Mark the cells whose centres lie in discs."""
    marked = np.zeros(costmap.shape, bool)
    for place, room in zip(places, radii.tolist(), strict=True):
        row, column = costmap.cells_of_points(place).tolist()
        reach = math.ceil(max(room, 0.0) / costmap.resolution)
        box = (
            slice(max(0, row - reach), max(0, row + reach + 1)),
            slice(max(0, column - reach), max(0, column + reach + 1)),
        )
        cells = np.moveaxis(np.indices(marked[box].shape), 0, -1) + np.array((box[0].start, box[1].start))
        marked[box] |= np.hypot(*np.moveaxis(costmap.points_of_cells(cells) - place, -1, 0)) < room
    return marked
