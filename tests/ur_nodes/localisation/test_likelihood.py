import math

import numpy as np
import pytest
from tests.ur_nodes.navigation.synthetic import make_room, scan_points

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.likelihood import (
    BeamModel,
    LikelihoodField,
    draw_free_poses,
    make_field,
    score_poses,
    signed_distances,
)

MODEL = BeamModel(z_hit=0.9, z_rand=0.1, sigma_hit=0.1, max_distance=2.0)


def test_signed_distances_agree_with_brute_force() -> None:
    walls = np.random.default_rng(1).random((25, 30)) < 0.08
    distances = signed_distances(walls, 0.1)
    on, off = np.argwhere(walls), np.argwhere(~walls)
    for cell in np.argwhere(np.ones_like(walls)):
        others, sign = (off, -1.0) if walls[tuple(cell)] else (on, 1.0)
        nearest = min(math.dist(cell, other) for other in others)
        assert distances[tuple(cell)] == pytest.approx(sign * 0.1 * (nearest - 0.5))


def test_field_of_a_map_without_walls_is_far_from_everything() -> None:
    field = make_field(Grid(np.zeros((4, 5), dtype=np.int8), 0.1, Pose2(0.0, 0.0, 0.0)), MODEL)
    assert (field.distances == 2.0).all()


def test_score_poses_agrees_with_the_formula() -> None:
    values = np.zeros((20, 20), dtype=np.int8)
    values[:, 15] = 100  # a wall whose surface is at x = 1.5
    field = make_field(Grid(values, 0.1, Pose2(0.0, 0.0, 0.0)), MODEL)
    score = score_poses(field, np.array(((0.95, 1.05, 0.0),)), np.array(((0.3, 0.0),)))
    # The beam ends in the cell whose centre is at x = 1.25, 0.25 m from the wall.
    expected = math.log((0.9 * math.exp(-0.5 * (0.25 / 0.1) ** 2) + 0.1) / 1.0)
    assert score[0] == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.5])
def test_score_poses_is_best_at_the_truth_however_the_map_lies(yaw: float) -> None:
    room = make_room()
    turned = Grid(room.values, room.resolution, Pose2(3.0, -1.0, yaw))
    truth = turned.origin.compose(Pose2(2.0, 1.5, 0.4))
    points = scan_points(turned, truth, np.random.default_rng(0))
    offsets = np.array(((0, 0, 0), (0.3, 0, 0), (0, -0.3, 0), (0, 0, 0.2), (0.3, 0.3, -0.2)))
    assert score_poses(make_field(turned, MODEL), offsets + np.array(truth), points).argmax() == 0


def test_draw_free_poses_covers_free_cells_only() -> None:
    field = make_field(make_room(), MODEL)
    poses = draw_free_poses(field, 5000, np.random.default_rng(0))
    assert (field.grid.values_at(poses[:, :2]) == 0).all()
    assert poses[:, :2].std(axis=0) == pytest.approx((8.0 / math.sqrt(12.0), 6.0 / math.sqrt(12.0)), rel=0.1)
    assert np.abs(poses[:, 2]).max() > 3.0


def test_field_of_a_large_map_is_that_of_a_small_one_where_beams_end() -> None:
    rng = np.random.default_rng(3)
    grid = Grid(np.where(rng.random((500, 1300)) < 0.002, 100, 0).astype(np.int8), 0.05, Pose2(0.0, 0.0, 0.0))
    poses = np.column_stack((rng.uniform(20, 24, 50), rng.uniform(9, 12, 50), rng.uniform(-3, 3, 50)))
    points = rng.normal(0.0, 2.0, (20, 2))
    whole = make_field(grid, MODEL)
    tiled = LikelihoodField(grid, MODEL, whole=0)
    assert (score_poses(tiled, poses, points) == score_poses(whole, poses, points)).all()
    assert not tiled.distances[:, -1].any()  # nothing ends there
    border = np.array(((-5.0, -5.0, 0.0), (70.0, 30.0, 0.0)))
    assert (score_poses(tiled, border, points) == score_poses(whole, border, points)).all()
