"""Poses in frames, and lines of them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from geometry_msgs.msg import Point32, PolygonStamped, PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Path as PathMessage
from nav_msgs.srv import GetPlan
from numpy.typing import NDArray

from ur_nodes.codecs.codec import Codec, ServiceCodec, fill_header, frame_of, value_or_fail
from ur_nodes.codecs.dialect import ROS_2, parts_of, stamp_of
from ur_nodes.codecs.geometry import checked_pose_of, fill_pose, matrix_of, numbers_of, pose_message, pose_of_message
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.services import AskPath
from ur_nodes.ports.values import Outline, Path, PoseEstimate, Poses, Result, StampedPose

if ROS_2 and not TYPE_CHECKING:  # as in `dialect`
    from geometry_msgs.msg import PoseArray as PosesMessage
else:
    from ur_nodes.codecs.genpy.scan import PosesMessage

_PlanRequest, _PlanResponse = parts_of(GetPlan)


def fill_stamped(message: PoseStamped, value: StampedPose) -> None:
    """Write a geometry_msgs/PoseStamped."""
    fill_header(message, value.stamp, value.frame)
    fill_pose(message.pose, value.pose)


def stamped_of(message: PoseStamped) -> StampedPose:
    """Read a geometry_msgs/PoseStamped."""
    return StampedPose(stamp_of(message.header.stamp), frame_of(message), checked_pose_of(message.pose))


def fill_estimate(message: PoseWithCovarianceStamped, value: PoseEstimate) -> None:
    """Write a geometry_msgs/PoseWithCovarianceStamped."""
    fill_header(message, value.stamp, value.frame)
    fill_pose(message.pose.pose, value.pose)
    message.pose.covariance = numbers_of(value.covariance)


def estimate_of(message: PoseWithCovarianceStamped) -> PoseEstimate:
    """Read a geometry_msgs/PoseWithCovarianceStamped."""
    return PoseEstimate(
        stamp_of(message.header.stamp),
        frame_of(message),
        checked_pose_of(message.pose.pose),
        matrix_of(message.pose.covariance),
    )


def _fill_poses(message: PosesMessage, value: Poses) -> None:
    fill_header(message, value.stamp, value.frame)
    if ROS_2:
        message.poses = [pose_message(Pose2(*each)) for each in value.poses.tolist()]
    else:
        message.planar = value.poses


def _poses_of(message: PosesMessage) -> Poses:
    return Poses(stamp_of(message.header.stamp), frame_of(message), _rows(pose_of_message(p) for p in message.poses))


def fill_path(message: PathMessage, value: Path) -> None:
    """Write a nav_msgs/Path."""
    fill_header(message, value.stamp, value.frame)
    message.poses = [
        PoseStamped(header=message.header, pose=pose_message(Pose2(*each))) for each in value.poses.tolist()
    ]


def path_of(message: PathMessage) -> Path:
    """Read a nav_msgs/Path."""
    rows = _rows(pose_of_message(each.pose) for each in message.poses)
    return Path(stamp_of(message.header.stamp), frame_of(message), rows)


def _fill_outline(message: PolygonStamped, value: Outline) -> None:
    fill_header(message, value.stamp, value.frame)
    message.polygon.points = [Point32(x=x, y=y, z=0.0) for x, y in value.corners.tolist()]


def _outline_of(message: PolygonStamped) -> Outline:
    corners = np.array([(p.x, p.y) for p in message.polygon.points], dtype=np.float64).reshape(-1, 2)
    return Outline(stamp_of(message.header.stamp), frame_of(message), corners)


def _rows(poses: Iterable[Pose2]) -> NDArray[np.float64]:
    return np.array(list(poses), dtype=np.float64).reshape(-1, 3)


def _ask_path_request(value: AskPath) -> GetPlan.Request:
    request = _PlanRequest(start=PoseStamped(), goal=PoseStamped(), tolerance=value.tolerance)
    fill_stamped(request.start, value.start)
    fill_stamped(request.goal, value.goal)
    return request


def _path_response(result: Result) -> GetPlan.Response:
    response = _PlanResponse()
    fill_path(response.plan, value_or_fail(result))
    return response


CODECS = {
    StampedPose: Codec(PoseStamped, fill_stamped, stamped_of),
    PoseEstimate: Codec(PoseWithCovarianceStamped, fill_estimate, estimate_of),
    Poses: Codec(PosesMessage, _fill_poses, _poses_of),
    Path: Codec(PathMessage, fill_path, path_of),
    Outline: Codec(PolygonStamped, _fill_outline, _outline_of),
}

SERVICES = {
    AskPath: ServiceCodec(
        GetPlan,
        _ask_path_request,
        lambda request: AskPath(stamped_of(request.start), stamped_of(request.goal), float(request.tolerance)),
        _path_response,
        lambda response: Result(success=True, value=path_of(response.plan)),
    )
}
