"""Conversion of goals and requests for plans to poses in the map."""

from __future__ import annotations

from ur_nodes.costmap.costmap import Costmap
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.transform_tree import TransformError, TransformTree
from ur_nodes.navigation.plan_request import PlanRequest
from ur_nodes.ports.services import AskPath
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.validation import problem_of
from ur_nodes.ports.values import PlacedPose

_HOLD = 1.0  # s by which transforms may be older than a goal, which is stamped as it is sent


def goal_in_map(target: PlacedPose, frames: TransformTree, map_frame: str) -> Pose2 | str:
    """Return the goal's pose in the map, or why it cannot be used."""
    goal = target.pose
    if problem := problem_of(target):
        return f"unusable goal: {problem}"
    if not target.frame:
        return f"the goal has no frame_id, expected {map_frame}"
    if target.frame == map_frame:
        return goal
    try:
        place = frames.pose(map_frame, target.frame, seconds_of(target.stamp) or None, hold=_HOLD)
    except TransformError as problem:
        return f"the goal is in the frame {target.frame}: {problem}"
    return place.compose(goal)


def read_request(
    request: AskPath,
    frames: TransformTree,
    map_frame: str,
    costs: tuple[Costmap, Costmap, Costmap | None] | None,
    here: Pose2 | None,
) -> PlanRequest | str:
    """Return a request of `~make_plan` in the map, or why there is no path.

    `costs` are the costmaps of `WorldView.costmaps`, `here` the robot in the map, for a request without a start.
    """
    goal = goal_in_map(request.goal, frames, map_frame)
    start = goal_in_map(request.start, frames, map_frame) if request.start.frame else here
    for each in (goal, start):
        if isinstance(each, str):
            return each
    if costs is None or not isinstance(goal, Pose2) or not isinstance(start, Pose2):
        return "no map or no pose yet"
    return PlanRequest(0, (start.x, start.y), (goal.x, goal.y), *costs)
