"""Goals and requests for plans as messages: their poses in the map, or why they cannot be used."""

from __future__ import annotations

import math

import rospy
from geometry_msgs.msg import PoseStamped
from nav_msgs.srv import GetPlanRequest, GetPlanResponse

from ur_nodes.costmap.costmap import Costmap
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.transform_tree import TransformError, TransformTree
from ur_nodes.navigation.move_base_parameters_node import MoveBaseSettings
from ur_nodes.navigation.move_base_view_node import path_message
from ur_nodes.navigation.plan_worker_node import PlanRequest, answer_request
from ur_nodes.rosio.geometry import pose_of_message

_HOLD = 1.0  # s by which transforms may be older than a goal, which is stamped as it is sent


def goal_in_map(target: PoseStamped, frames: TransformTree, map_frame: str) -> Pose2 | str:
    """The goal's pose in the map, or why it cannot be used."""
    position, turn = target.pose.position, target.pose.orientation
    numbers = (position.x, position.y, turn.x, turn.y, turn.z, turn.w)
    if not all(math.isfinite(number) for number in numbers):
        return "a number of the goal is not finite, expected a pose"
    if abs(math.hypot(*numbers[2:]) - 1.0) > 0.1:
        return "the goal's orientation is not a unit quaternion, expected one (for no rotation: w = 1)"
    frame = target.header.frame_id.lstrip("/")
    goal: Pose2 = pose_of_message(target.pose)
    if not frame:
        return f"the goal has no frame_id, expected {map_frame}"
    if frame == map_frame:
        return goal
    stamp = target.header.stamp.to_sec() or None
    try:
        return frames.pose(map_frame, frame, stamp, hold=_HOLD).compose(goal)
    except TransformError as problem:
        return f"the goal is in the frame {frame}: {problem}"


def make_plan(
    request: GetPlanRequest,
    frames: TransformTree,
    settings: MoveBaseSettings,
    costs: tuple[Costmap, Costmap, Costmap | None] | None,
    here: Pose2 | None,
) -> GetPlanResponse:
    """The answer of `~make_plan`: a path without poses, and a line in the log, where there is none.

    `costs` are the costmaps of `WorldView.costmaps`, `here` the robot in the map, for a request without a start.
    """
    frame = settings.world.frame
    response = GetPlanResponse()
    response.plan.header.frame_id = frame
    goal = goal_in_map(request.goal, frames, frame)
    start = goal_in_map(request.start, frames, frame) if request.start.header.frame_id else here
    if costs is None or not isinstance(goal, Pose2) or not isinstance(start, Pose2):
        problems = [x for x in (goal, start) if isinstance(x, str)]
        rospy.logerr("make_plan: %s", problems[0] if problems else "no map or no pose yet")
        return response
    answer = answer_request(PlanRequest(0, (start.x, start.y), (goal.x, goal.y), *costs), settings.planner)
    if answer.path is None:
        rospy.logerr("make_plan: %s", answer.reason)
    else:
        response.plan = path_message(answer.path, frame)
    return response
