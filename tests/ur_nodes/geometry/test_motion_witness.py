import math

import numpy as np
import pytest
from tests.ur_nodes.navigation.synthetic import LASER, make_room, scan_points

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.motion_witness import MotionWitness, confirmed_share
from ur_nodes.geometry.pose import Pose2

ROOM = make_room()
SENSOR = LASER[:2]
CLAIMS = [Pose2(0.08, 0.0, 0.0), Pose2(-0.1, 0.0, 0.05), Pose2(0.0, 0.0, 0.2), Pose2(0.06, 0.08, 0.0)]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("claim", CLAIMS)
def test_scans_confirm_a_motion_that_happened_and_no_other(claim: Pose2, seed: int) -> None:
    rng = np.random.default_rng(seed)
    here = Pose2(*rng.uniform((0.0, -1.0, -3.0), (2.0, 0.0, 3.0)))
    before = scan_points(ROOM, here, rng)
    there = scan_points(ROOM, here.compose(claim), rng)
    assert confirmed_share(before, there, claim, SENSOR) == pytest.approx(1.0, abs=0.3)
    assert confirmed_share(before, scan_points(ROOM, here, rng), claim, SENSOR) == pytest.approx(0.0, abs=0.2)


def test_scans_without_a_feature_along_the_way_cannot_tell() -> None:
    corridor = np.zeros((40, 2000), np.int8)
    corridor[:2] = corridor[-2:] = 100
    grid, rng = Grid(corridor, 0.05, Pose2(-50.0, -1.0, 0.0)), np.random.default_rng(1)
    for turn in rng.normal(0.0, 0.003, 40):  # as odometry of wheels has it
        before, after = scan_points(grid, Pose2(0.0, 0.0, 0.0), rng), scan_points(grid, Pose2(0.1, 0.0, 0.0), rng)
        assert confirmed_share(before, after, Pose2(0.1, 0.0, float(turn)), SENSOR) is None
    scan = scan_points(grid, Pose2(0.0, 0.0, 0.0), rng)
    assert confirmed_share(scan, np.empty((0, 2)), Pose2(0.1, 0.0, 0.0), SENSOR) is None


def test_beam_an_almost_full_turn_away_counts_as_any_other() -> None:
    angles = np.linspace(-0.3, 0.3, 41)
    angles[20] = -1e-20  # plus a full turn, that is a full turn
    wall = np.column_stack((2.0 * np.cos(angles), 2.0 * np.sin(angles)))
    assert confirmed_share(wall, wall - (0.1, 0.0), Pose2(0.1, 0.0, 0.0), (0.0, 0.0)) is None  # two sectors only


def test_person_who_walks_ahead_is_no_witness() -> None:
    angles = np.linspace(-0.3, 0.3, 40)
    person = np.column_stack((np.cos(angles), np.sin(angles)))
    assert confirmed_share(person, person, Pose2(0.1, 0.0, 0.0), (0.0, 0.0)) is None


def test_witness_adds_up_what_wheels_turn_in_vain_until_the_robot_moves() -> None:
    witness, rng, truth = MotionWitness(), np.random.default_rng(2), Pose2(1.0, -1.0, 0.3)
    for step in range(6):
        slip = witness.update(Pose2(0.07 * step, 0.0, 0.0), scan_points(ROOM, truth, rng), SENSOR)
        assert (slip is not None) == (step > 0)
    assert witness.slipped == pytest.approx(0.35)
    moved = truth.compose(Pose2(0.07, 0.0, 0.0))
    assert witness.update(Pose2(0.42, 0.0, 0.0), scan_points(ROOM, moved, rng), SENSOR) is None
    assert math.isclose(witness.slipped, 0.0)
    witness.restart()
    assert witness.update(Pose2(9.0, 0.0, 0.0), scan_points(ROOM, moved, rng), SENSOR) is None
