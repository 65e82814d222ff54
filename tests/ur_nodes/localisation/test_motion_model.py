import math

import numpy as np
import pytest

from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.motion_model import MotionModel, OdometryKind, decompose, move_poses, spread_of_steps

EXACT = MotionModel("diff-corrected", 0.0, 0.0, 0.0, 0.0)


def test_move_poses_without_noise_repeats_the_odometrys_movement() -> None:
    before, after = Pose2(4.0, -1.0, 2.0), Pose2(4.5, -1.3, 2.7)
    start = Pose2(1.0, 2.0, -0.5)
    moved = move_poses(np.array((start,)), before, after, EXACT, np.random.default_rng(0))
    assert moved[0] == pytest.approx(start.compose(before.inverse().compose(after)))


def test_decompose_takes_a_robot_that_hardly_moved_as_turning() -> None:
    steps = decompose(Pose2(0.0, 0.0, 0.0), Pose2(0.0, 0.005, 0.3))
    assert steps.turn1 == 0.0
    assert steps.turn2 == pytest.approx(0.3)


def test_spread_counts_driving_backwards_as_driving() -> None:
    model = MotionModel("diff-corrected", 0.2, 0.2, 0.2, 0.2)
    forwards = spread_of_steps(decompose(Pose2(0.0, 0.0, 0.0), Pose2(1.0, 0.0, 0.0)), model)
    backwards = spread_of_steps(decompose(Pose2(0.0, 0.0, 0.0), Pose2(-1.0, 0.0, 0.0)), model)
    assert (backwards.turn1, backwards.drive, backwards.turn2) == pytest.approx(
        (forwards.turn1, forwards.drive, forwards.turn2)
    )


@pytest.mark.parametrize(("kind", "expected"), [("diff-corrected", math.sqrt(0.01 * 4.0)), ("diff", 0.01 * 4.0)])
def test_move_poses_spreads_along_the_way_as_alpha3_says(kind: OdometryKind, expected: float) -> None:
    model = MotionModel(kind, 0.0, 0.0, 0.01, 0.0)
    moved = move_poses(
        np.zeros((20000, 3)), Pose2(0.0, 0.0, 0.0), Pose2(2.0, 0.0, 0.0), model, np.random.default_rng(3)
    )
    assert moved[:, 0].mean() == pytest.approx(2.0, abs=4.0 * expected / math.sqrt(20000))
    assert moved[:, 0].std() == pytest.approx(expected, rel=0.03)
    assert np.abs(moved[:, 1:]).max() == 0.0


def test_move_poses_keeps_headings_within_half_a_turn() -> None:
    moved = move_poses(
        np.array(((0.0, 0.0, 3.0),)), Pose2(0.0, 0.0, 0.0), Pose2(0.0, 0.0, 1.0), EXACT, np.random.default_rng(0)
    )
    assert moved[0, 2] == pytest.approx(4.0 - 2.0 * math.pi)


@pytest.mark.parametrize("kind", ["omni", "omni-corrected"])
def test_omni_model_without_noise_repeats_a_movement_to_the_side(kind: OdometryKind) -> None:
    before = Pose2(4.0, -1.0, 2.0)
    after = before.compose(Pose2(0.1, 0.6, 0.2))
    start = Pose2(1.0, 2.0, -0.5)
    model = MotionModel(kind, 0.0, 0.0, 0.0, 0.0)
    moved = move_poses(np.array((start,)), before, after, model, np.random.default_rng(0))
    assert moved[0] == pytest.approx(start.compose(Pose2(0.1, 0.6, 0.2)))


@pytest.mark.parametrize(("kind", "expected"), [("omni-corrected", math.sqrt(0.01 * 4.0)), ("omni", 0.01 * 4.0)])
def test_omni_model_spreads_along_and_across_a_movement_to_the_side(kind: OdometryKind, expected: float) -> None:
    left, rng = Pose2(0.0, 2.0, 0.0), np.random.default_rng(3)
    along = move_poses(np.zeros((20000, 3)), Pose2(0.0, 0.0, 0.0), left, MotionModel(kind, 0, 0, 0.01, 0), rng)
    assert along[:, 1].mean() == pytest.approx(2.0, abs=4.0 * expected / math.sqrt(20000))
    assert along[:, 1].std() == pytest.approx(expected, rel=0.03)
    assert np.abs(along[:, (0, 2)]).max() < 1e-12
    across = move_poses(np.zeros((20000, 3)), Pose2(0.0, 0.0, 0.0), left, MotionModel(kind, 0, 0, 0, 0, 0.01), rng)
    assert across[:, 0].std() == pytest.approx(expected, rel=0.03)
    assert np.abs(across[:, (1, 2)] - (2.0, 0.0)).max() < 1e-12


def test_omni_model_does_not_take_a_movement_to_the_side_for_turns() -> None:
    movement = Pose2(0.0, 0.5, 0.0)
    turned = [
        move_poses(np.zeros((2000, 3)), Pose2(0.0, 0.0, 0.0), movement, model, np.random.default_rng(1))[:, 2].std()
        for model in (
            MotionModel("omni-corrected", 0.02, 0.0, 0.02, 0.02, 0.02),
            MotionModel("diff-corrected", 0.02, 0.0, 0.02, 0.02),
        )
    ]
    assert turned[0] == 0.0
    assert turned[1] > 0.2
