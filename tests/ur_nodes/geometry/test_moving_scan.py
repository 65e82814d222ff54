"""Scans of a robot that moves, against those of the same lidar at rest: a room of 4 x 3 m."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.geometry.scan import SensorMount, mount_of_pose
from ur_nodes.geometry.scan_time import ranges_at_one_moment, velocity_between

COUNT = 360
STEP = 2.0 * math.pi / COUNT
MOUNT = mount_of_pose(Pose3(0.1, -0.05, 0.2, 0.0, 0.0, math.sin(0.4), math.cos(0.4)))
UPSIDE_DOWN = mount_of_pose(Pose3(0.1, 0.0, 0.2, 1.0, 0.0, 0.0, 0.0))
VELOCITY = (0.5, 0.0, 0.8)


def measure(robot: Pose2, angle: float, mount: SensorMount) -> float:
    """One beam to the walls."""
    direction = mount.rotation[:2, :2] @ np.array((math.cos(angle), math.sin(angle)))
    c, s = math.cos(robot.yaw), math.sin(robot.yaw)
    turn = np.array(((c, -s), (s, c)))
    (x, y), (dx, dy) = turn @ mount.offset[:2] + (robot.x, robot.y), turn @ direction
    ways = [(w - p) / d for p, d, half in ((x, dx, 2.0), (y, dy, 1.5)) if abs(d) > 1e-9 for w in (-half, half)]
    return float(min(way for way in ways if way > 0.0))


def scans(mount: SensorMount, times: NDArray[np.float64]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The ranges at rest, and those while it drives a curve."""
    still, moving = np.zeros(COUNT, np.float32), np.zeros(COUNT, np.float32)
    v, _, w = VELOCITY
    for beam, time in enumerate(times):
        angle = -math.pi + beam * STEP
        turn = w * float(time)
        robot = Pose2(v * float(time) * math.cos(turn / 2.0), v * float(time) * math.sin(turn / 2.0), turn)
        still[beam] = measure(Pose2(0.0, 0.0, 0.0), angle, mount)
        moving[beam] = measure(robot, angle, mount)
    return still, moving


@pytest.mark.parametrize("mount", [MOUNT, UPSIDE_DOWN])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_motion_of_the_robot_is_taken_out_of_its_scan(mount: SensorMount, sign: float) -> None:
    times = sign * (np.arange(COUNT) - (COUNT - 1) / 2.0) * 0.2 / COUNT
    still, moving = scans(mount, times)
    found = ranges_at_one_moment(moving, -math.pi, STEP, times, VELOCITY, mount)
    seen = ~np.isnan(found)
    assert np.abs(moving - still).max() > 0.1
    assert seen.mean() > 0.9  # the turn of the robot leaves out what no beam has passed
    assert np.median(np.abs(found - still)[seen]) < 0.001
    assert np.quantile(np.abs(found - still)[seen], 0.97) < 0.02


def test_beams_without_a_return_stay_without_one() -> None:
    times = (np.arange(COUNT) - (COUNT - 1) / 2.0) * 0.1 / COUNT
    ranges = np.full(COUNT, 2.0, np.float32)
    ranges[100:150], ranges[200:220], ranges[300:310] = np.inf, -np.inf, np.nan
    found = ranges_at_one_moment(ranges, -math.pi, STEP, times, (0.0, 0.0, 0.5), MOUNT)
    assert np.isposinf(found[105:145]).all()
    assert np.isneginf(found[205:215]).all()
    assert np.isnan(found[303:307]).all()
    nothing = np.full(COUNT, np.nan, np.float32)
    assert np.isnan(ranges_at_one_moment(nothing, -math.pi, STEP, times, VELOCITY, MOUNT)).all()


def test_velocity_is_that_of_the_robots_own_frame_in_the_middle() -> None:
    start, end = (
        Pose2(1.0, 2.0, 0.3),
        Pose2(1.0, 2.0, 0.3).compose(Pose2(0.4 * math.cos(0.2), 0.4 * math.sin(0.2), 0.4)),
    )
    assert velocity_between(start, end, 2.0) == pytest.approx((0.2, 0.0, 0.2))
