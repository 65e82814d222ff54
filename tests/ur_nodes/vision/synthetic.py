"""A robot with a camera and drifting wheels among fiducials, without pictures: corners are projected, with noise."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.geometry.rigid import Floats, from_angles, from_planar, invert
from ur_nodes.vision.detect import CameraModel, corner_points, estimate_poses
from ur_nodes.vision.estimation.observation import Observation, make_observation

WIDTH, HEIGHT, FOCAL = 640, 480, 531.0
CAMERA = CameraModel(
    np.array([[FOCAL, 0.0, (WIDTH - 1) / 2], [0.0, FOCAL, (HEIGHT - 1) / 2], [0.0, 0.0, 1.0]]), np.zeros(5)
)
# A camera at 0.135 m that looks ahead and up by 24 degrees; its optical frame.
MOUNT = from_angles((0.05, 0.085, 0.135), (0.0, -0.4189, 0.0)) @ from_angles(
    (0.0, 0.0, 0.0), (-math.pi / 2, 0.0, -math.pi / 2)
)


@dataclass(frozen=True)
class Marker:
    id: int
    pose: Floats
    size: float


def project(camera_from_marker: Floats, size: float) -> Floats | None:
    """Corners in the picture, or None where the marker is not seen."""
    points = corner_points(size) @ camera_from_marker[:3, :3].T + camera_from_marker[:3, 3]
    facing = -(camera_from_marker[:3, 2] @ camera_from_marker[:3, 3]) / np.linalg.norm(camera_from_marker[:3, 3])
    if points[:, 2].min() < 0.1 or facing < 0.25:
        return None
    pixels = points @ CAMERA.matrix.T
    pixels = pixels[:, :2] / pixels[:, 2:]
    inside = (pixels > 3).all() and (pixels[:, 0] < WIDTH - 4).all() and (pixels[:, 1] < HEIGHT - 4).all()
    edge = np.linalg.norm(np.diff(pixels, axis=0), axis=1).min()
    return pixels if inside and edge > 14.0 else None


def look(robot: Pose2, markers: Iterable[Marker], random: np.random.Generator, noise: float = 0.3) -> list[Observation]:
    """What the robot sees."""
    camera_from_map = invert(from_planar(robot) @ MOUNT)
    seen = []
    for marker in markers:
        corners = project(camera_from_map @ marker.pose, marker.size)
        if corners is None:
            continue
        poses = estimate_poses(corners + random.normal(0.0, noise, (4, 2)), marker.size, CAMERA)
        seen.append(make_observation(marker.id, MOUNT, poses))
    return seen


def drive(corners: list[tuple[float, float]], step: float = 0.05) -> Iterator[Pose2]:
    """Straight lines between corners, turning on the spot at each."""
    heading = 0.0
    for (x0, y0), (x1, y1) in pairwise(corners):
        wanted = math.atan2(y1 - y0, x1 - x0)
        turn = wrap_angle(wanted - heading)
        turns = max(1, math.ceil(abs(turn) / 0.1))
        for n in range(1, turns + 1):
            yield Pose2(x0, y0, wrap_angle(heading + turn * n / turns))
        heading = wanted
        steps = max(1, math.ceil(math.hypot(x1 - x0, y1 - y0) / step))
        for n in range(1, steps + 1):
            yield Pose2(x0 + (x1 - x0) * n / steps, y0 + (y1 - y0) * n / steps, heading)


def drift(path: Iterable[Pose2], random: np.random.Generator) -> Iterator[tuple[Pose2, Pose2]]:
    """Each pose with what odometry says: scale and turn are off, and every step a little."""
    said, last = Pose2(0.0, 0.0, 0.0), None
    for pose in path:
        if last is not None:
            motion = last.inverse().compose(pose)
            way = math.hypot(motion.x, motion.y)
            turn = 1.015 * motion.yaw + 0.004 * way + random.normal(0.0, 0.002)
            said = said.compose(Pose2(1.01 * motion.x + random.normal(0.0, 0.001), motion.y, turn))
        last = pose
        yield pose, said
