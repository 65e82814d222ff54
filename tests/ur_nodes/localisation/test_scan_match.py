import math

import numpy as np
import pytest
from tests.ur_nodes.navigation.synthetic import make_room, scan_points

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.likelihood import BeamModel, make_field
from ur_nodes.localisation.scan_match import MatchSettings, match_many, match_scan

MODEL = BeamModel(z_hit=0.9, z_rand=0.1, sigma_hit=0.1, max_distance=2.0)
WIDE = np.diag((0.2**2, 0.2**2, 0.1**2))


@pytest.mark.parametrize("yaw", [0.0, 1.2])
def test_match_scan_finds_the_pose_to_within_a_centimetre(yaw: float) -> None:
    room = Grid(make_room().values, 0.05, Pose2(-1.0, -2.0, yaw))
    truth = room.origin.compose(Pose2(2.1, 1.4, 0.8))
    points = scan_points(room, truth, np.random.default_rng(0))
    start = Pose2(truth.x + 0.06, truth.y - 0.05, truth.yaw + 0.04)
    match = match_scan(make_field(room, MODEL), start, WIDE, points, MatchSettings())
    assert math.dist(match.pose[:2], truth[:2]) < 0.01
    assert match.pose.yaw == pytest.approx(truth.yaw, abs=0.005)
    assert match.agreement > 0.9


def test_match_scan_is_not_led_astray_by_what_the_map_does_not_have() -> None:
    room, truth = make_room(), Pose2(1.0, 0.0, 0.0)
    points = scan_points(room, truth, np.random.default_rng(0))
    near = np.abs(np.arctan2(points[:, 1], points[:, 0])) < 0.5  # somebody stands in front
    points[near] *= 0.4
    match = match_scan(make_field(room, MODEL), Pose2(1.03, 0.02, 0.02), WIDE, points, MatchSettings())
    assert math.dist(match.pose[:2], truth[:2]) < 0.01
    assert match.agreement < 0.9


def test_match_scan_leaves_to_the_prior_what_a_corridor_does_not_tell() -> None:
    values = np.zeros((60, 800), dtype=np.int8)
    values[:2] = values[-2:] = 100
    corridor = Grid(values, 0.05, Pose2(-20.0, -1.5, 0.0))
    points = scan_points(corridor, Pose2(0.0, 0.0, 0.0), np.random.default_rng(0))
    prior = Pose2(0.3, 0.1, 0.02)
    match = match_scan(make_field(corridor, MODEL), prior, WIDE, points, MatchSettings())
    assert match.pose.x == pytest.approx(0.3, abs=0.02)
    assert match.pose.y == pytest.approx(0.0, abs=0.01)
    assert match.covariance[0, 0] > 100.0 * match.covariance[1, 1]


def test_match_many_pulls_poses_to_the_truth_and_keeps_none_outside_a_half_turn() -> None:
    room, truth = make_room(), Pose2(2.0, -0.5, 3.1)
    points = scan_points(room, truth, np.random.default_rng(0))
    starts = np.array(truth) + np.random.default_rng(1).normal(0.0, 0.05, (20, 3))
    moved = match_many(make_field(room, MODEL), starts, points, MatchSettings(outlier=0.4, iterations=8))
    assert np.median(np.linalg.norm(moved[:, :2] - truth[:2], axis=1)) < 0.02
    assert np.abs(moved[:, 2]).max() <= math.pi
