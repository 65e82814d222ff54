"""A corridor without a feature: how far off a robot may be along it, and the wall at its end."""

import math

import numpy as np
import pytest
from tests.ur_nodes.localisation.test_localiser import SURE, start
from tests.ur_nodes.navigation.synthetic import scan_points

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.amcl import BlindWay
from ur_nodes.localisation.likelihood import BeamModel, LikelihoodField, make_field
from ur_nodes.localisation.localiser import ClusterEstimate, ParticleLocaliser

END = 25.0  # m: the wall at the end
SENSOR_REACH = 15.0  # m, rather more than the lidar's


@pytest.fixture(scope="module")
def corridor() -> LikelihoodField:
    cells = np.zeros((40, 1000), np.int8)
    cells[:2] = cells[-2:] = cells[:, -2:] = 100
    grid = Grid(cells, 0.05, Pose2(END - 50.0, -1.0, 0.0))
    return make_field(grid, BeamModel(z_hit=0.9, z_rand=0.1, sigma_hit=0.1, max_distance=2.0))


def drive(
    blind: BlindWay, localiser: ParticleLocaliser, field: LikelihoodField, start_at: float, end_at: float
) -> None:
    rng = np.random.default_rng(1)
    for x in np.arange(start_at, end_at, 0.5):
        pose = Pose2(float(x), 0.0, 0.0)
        blind.update(pose, localiser.match_alone(pose, scan_points(field.grid, pose, rng)))


def test_place_along_a_corridor_becomes_as_uncertain_as_wheels_are(corridor: LikelihoodField) -> None:
    blind, localiser = BlindWay(), start(corridor)
    drive(blind, localiser, corridor, -10.0, 6.01)
    assert blind.spread == pytest.approx(0.03 * 16.0, rel=0.1)
    wider = blind.widen(ClusterEstimate(Pose2(6.0, 0.0, 0.0), SURE, 1.0)).covariance
    assert math.sqrt(wider[0, 0]) == pytest.approx(blind.spread, rel=0.05)
    assert math.sqrt(wider[1, 1]) == pytest.approx(0.05, rel=0.05)
    drive(blind, localiser, corridor, END - 4.0, END - 1.9)
    assert math.isclose(blind.spread, 0.0)
    blind.restart()
    drive(blind, localiser, corridor, -10.0, -7.9)
    assert math.isclose(blind.spread, 0.0), "two metres are too few to be off"


def test_wall_at_the_end_shows_where_the_robot_is(corridor: LikelihoodField) -> None:
    rng, truth = np.random.default_rng(2), Pose2(END - 5.0, 0.0, 0.0)
    points = scan_points(corridor.grid, truth, rng)
    axis, localiser = np.array((1.0, 0.0)), start(corridor)
    for off in (-0.9, 0.9):
        found = localiser.find_along(Pose2(truth.x + off, 0.0, 0.0), axis, 1.2, points)
        assert found is not None
        assert found.x == pytest.approx(truth.x, abs=0.1)
    assert localiser.find_along(truth, axis, 1.2, points) is None
    middle = Pose2(END - SENSOR_REACH - 5.0, 0.0, 0.0)
    assert localiser.find_along(middle, axis, 1.2, scan_points(corridor.grid, middle, rng)) is None
    assert localiser.find_along(middle, axis, 0.0, points) is None
