import numpy as np
import pytest

from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.obstacle_stop.sight import Odometer, Track, follow


def drive(*readings: Odometer) -> Track:
    track = Track()
    for reading in readings:
        track, _ = follow(track, reading)
    return track


AHEAD = drive(Odometer(Pose2(0.0, 0.0, 0.0), 0.5, 0.0, 1.0), Odometer(Pose2(0.05, 0.0, 0.0), 0.5, 0.0, 1.1))


@pytest.mark.parametrize(
    ("at", "x"), [(0.5, 0.0), (1.0, 0.0), (1.04, 0.02), (1.1, 0.05), (1.2, 0.1), (1.4, 0.2), (9.0, 0.2)]
)
def test_pose_is_interpolated_and_goes_on_for_a_moment(at: float, x: float) -> None:
    assert AHEAD.pose_at(at).x == pytest.approx(x)


def test_pose_without_odometry_is_the_origin() -> None:
    assert Track().pose_at(5.0) == (0.0, 0.0, 0.0)
    assert Track().age(5.0) == float("inf")


def test_pose_follows_the_arc_across_half_a_turn() -> None:
    track = drive(Odometer(Pose2(0.0, 0.0, 3.1), 0.0, 1.0, 1.0), Odometer(Pose2(0.0, 0.0, -3.1), 0.0, 1.0, 1.1))
    assert abs(track.pose_at(1.05).yaw) == pytest.approx(3.1416, abs=1e-3)


def test_poses_of_beams_spread_over_the_scan() -> None:
    poses = AHEAD.poses_at(np.array([1.0, 1.05, 1.1]))
    assert poses[:, 0] == pytest.approx([0.0, 0.025, 0.05])


def test_odometry_that_begins_anew_forgets_the_way() -> None:
    track, same = follow(AHEAD, Odometer(Pose2(3.0, 0.0, 0.0), 0.0, 0.0, 1.2))
    assert not same
    assert len(track.readings) == 1
    _, same = follow(AHEAD, Odometer(Pose2(0.1, 0.0, 0.0), 0.5, 0.0, 1.2))
    assert same


def test_older_reading_is_ignored() -> None:
    assert follow(AHEAD, Odometer(Pose2(0.0, 0.0, 0.0), 0.0, 0.0, 1.05)) == (AHEAD, True)


def test_track_goes_on_sideways_with_a_base_that_does() -> None:
    track = drive(
        Odometer(Pose2(0.0, 0.0, 0.0), 0.0, 0.0, 1.0, 0.4), Odometer(Pose2(0.0, 0.04, 0.0), 0.0, 0.0, 1.1, 0.4)
    )
    assert track.pose_at(1.2) == pytest.approx((0.0, 0.08, 0.0))
