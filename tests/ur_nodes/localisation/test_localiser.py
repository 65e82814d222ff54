import math

import numpy as np
import pytest
from tests.ur_nodes.navigation.synthetic import Drifter, make_room, scan_points

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.localisation.likelihood import BeamModel, LikelihoodField, make_field
from ur_nodes.localisation.localiser import POOL, ClusterEstimate, FilterSettings, ParticleLocaliser, pool_size
from ur_nodes.localisation.motion_model import MotionModel
from ur_nodes.localisation.particle_filter import SampleSize

SIZE = SampleSize(minimum=200, maximum=5000, kld_err=0.05, kld_z=2.33)
MOTION = MotionModel("diff-corrected", 0.02, 0.02, 0.02, 0.02)
SETTINGS = FilterSettings(SIZE, MOTION, max_beams=60, update_min_d=0.05, update_min_a=0.05, resample_interval=1)
SURE = np.diag((0.05**2, 0.05**2, 0.02**2))


@pytest.fixture(scope="module")
def field() -> LikelihoodField:
    return make_field(make_room(), BeamModel(z_hit=0.9, z_rand=0.1, sigma_hit=0.1, max_distance=2.0))


def start(field: LikelihoodField, settings: FilterSettings = SETTINGS, seed: int = 0) -> ParticleLocaliser:
    return ParticleLocaliser(field, settings, np.random.default_rng(seed))


def errors_of_drive(
    localiser: ParticleLocaliser,
    robot: Drifter,
    field: LikelihoodField,
    steps: int,
    distance: float = 0.08,
    turn: float = 0.05,
) -> list[float]:
    rng = np.random.default_rng(9)
    errors = []
    for _ in range(steps):
        robot.drive(distance, turn)
        estimate = localiser.update(robot.odometry, scan_points(field.grid, robot.truth, rng))
        assert estimate
        assert abs(wrap_angle(estimate.pose.yaw - robot.truth.yaw)) < math.pi
        errors.append(math.dist(estimate.pose[:2], robot.truth[:2]))
    return errors


@pytest.mark.parametrize(("refine", "mean", "worst"), [(True, 0.005, 0.04), (False, 0.06, 0.15)])
def test_localiser_follows_a_robot_whose_odometry_drifts(
    field: LikelihoodField, refine: bool, mean: float, worst: float
) -> None:
    from dataclasses import replace

    localiser = start(field, replace(SETTINGS, refine=refine))
    robot = Drifter(Pose2(1.0, -0.6, 0.0), np.random.default_rng(4))
    localiser.set_pose(robot.truth, SURE)
    errors = errors_of_drive(localiser, robot, field, 60)
    assert np.mean(errors) < mean
    assert max(errors) < worst


def test_localiser_follows_a_robot_whose_wheels_slip_on_a_carpet(field: LikelihoodField) -> None:
    localiser = start(field)
    robot = Drifter(Pose2(1.0, -0.6, 0.0), np.random.default_rng(4), slip=0.15)
    localiser.set_pose(robot.truth, SURE)
    assert np.mean(errors_of_drive(localiser, robot, field, 60)) < 0.004


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_localiser_finds_a_robot_that_may_be_anywhere(field: LikelihoodField, seed: int) -> None:
    localiser = start(field, seed=seed)
    robot = Drifter(Pose2(0.0, 2.5, 2.0), np.random.default_rng(seed))
    assert localiser.scatter()
    assert len(localiser.particles) > 2000
    errors = errors_of_drive(localiser, robot, field, 50, distance=0.0, turn=0.1)
    assert max(errors[-5:]) < 0.03
    assert len(localiser.particles) < 500


def test_localiser_notices_a_kidnapping_when_recovery_is_on(field: LikelihoodField) -> None:
    from dataclasses import replace

    localiser = start(field, replace(SETTINGS, recovery_alpha_slow=0.005, recovery_alpha_fast=0.2))
    robot = Drifter(Pose2(1.0, -0.6, 0.0), np.random.default_rng(4))
    localiser.set_pose(robot.truth, SURE)
    errors_of_drive(localiser, robot, field, 20)
    robot.truth = Pose2(5.5, 2.5, -2.0)
    errors = errors_of_drive(localiser, robot, field, 40, distance=0.0, turn=0.1)
    assert errors[0] > 1.0
    assert max(errors[-5:]) < 0.03


def test_robot_that_is_carried_away_is_noticed_and_found(field: LikelihoodField) -> None:
    localiser = start(field)
    robot = Drifter(Pose2(1.0, -0.6, 0.0), np.random.default_rng(4))
    localiser.set_pose(robot.truth, SURE)
    errors_of_drive(localiser, robot, field, 20)
    assert not localiser.lost
    robot.truth = Pose2(5.5, 2.5, -2.0)
    errors_of_drive(localiser, robot, field, 6)
    assert localiser.lost
    rng = np.random.default_rng(9)
    for _ in range(30):  # it stands still
        estimate = (
            localiser.update(robot.odometry, scan_points(field.grid, robot.truth, rng)) if localiser.lost else None
        )
        if estimate is None:
            break
        found = estimate.pose
    assert not localiser.lost
    assert math.dist(found[:2], robot.truth[:2]) < 0.05


def test_robot_that_is_carried_away_and_then_stands_still_is_noticed(field: LikelihoodField) -> None:
    localiser, rng = start(field), np.random.default_rng(9)
    robot = Drifter(Pose2(1.0, -0.6, 0.0), np.random.default_rng(4))
    localiser.set_pose(robot.truth, SURE)
    errors_of_drive(localiser, robot, field, 2)
    robot.truth = Pose2(5.5, 2.5, -2.0)
    robot.drive(0.3, 0.0)
    for _ in range(5):
        localiser.update(robot.odometry, scan_points(field.grid, robot.truth, rng))
    assert localiser.lost


def test_robot_among_people_or_without_its_furniture_is_not_lost(field: LikelihoodField) -> None:
    changed = Grid(field.grid.values.copy(), field.grid.resolution, field.grid.origin)
    changed.values[20:40, 110:124] = changed.values[105:112, 130:150] = 0
    localiser, rng = start(field), np.random.default_rng(2)
    robot = Drifter(Pose2(1.0, -0.6, 0.0), np.random.default_rng(4))
    localiser.set_pose(robot.truth, SURE)
    for number in range(120):
        robot.drive(0.05, 0.06)
        points = scan_points(changed, robot.truth, rng)
        people = np.convolve(rng.random(len(points)) < 0.06, np.ones(12), "same") > 0.0  # about half of the beams
        points[people] *= (0.8 / np.hypot(*points[people].T)).clip(max=1.0)[:, None]
        localiser.update(robot.odometry, points)
        assert not localiser.lost, number


def test_place_given_by_hand_ends_the_search(field: LikelihoodField) -> None:
    localiser = start(field)
    robot = Drifter(Pose2(1.0, -0.6, 0.0), np.random.default_rng(4))
    localiser.set_pose(robot.truth, SURE)
    robot.truth = Pose2(5.5, 2.5, -2.0)
    errors_of_drive(localiser, robot, field, 5)
    assert localiser.lost
    localiser.set_pose(robot.truth, SURE)
    assert not localiser.lost
    assert max(errors_of_drive(localiser, robot, field, 5)) < 0.1


def test_search_of_a_large_map_tries_more_poses(field: LikelihoodField) -> None:
    assert pool_size(field) == POOL
    large = Grid(np.zeros((1000, 1000), dtype=np.int8), 0.05, Pose2(0.0, 0.0, 0.0))
    assert pool_size(make_field(large, BeamModel(0.9, 0.1, 0.1, 2.0))) == 100000


def test_robot_that_sees_one_of_two_equal_rooms_may_be_in_either() -> None:
    values = np.zeros((84, 204), dtype=np.int8)
    values[:2], values[-2:] = 100, 100
    values[:, :2], values[:, 101:103], values[:, -2:] = 100, 100, 100
    values[20:40, 20:30], values[20:40, 121:131] = 100, 100  # a cupboard in each
    grid = Grid(values, 0.05, Pose2(0.0, 0.0, 0.0))
    localiser = start(make_field(grid, BeamModel(0.9, 0.1, 0.1, 2.0)))
    robot = Drifter(Pose2(3.0, 3.0, 0.0), np.random.default_rng(0))
    assert localiser.scatter()
    rng = np.random.default_rng(9)
    for _ in range(12):
        robot.drive(0.0, 0.1)
        localiser.update(robot.odometry, scan_points(grid, robot.truth, rng))
    first, second = sorted(localiser.poses)
    assert math.dist(first[:2], (3.0, 3.0)) < 0.1
    assert math.dist(second[:2], (8.05, 3.0)) < 0.1
    localiser.set_pose(robot.truth, SURE)
    assert localiser.poses == []


def test_localiser_waits_until_the_robot_has_moved(field: LikelihoodField) -> None:
    localiser = start(field)
    truth = Pose2(1.0, -0.6, 0.0)
    points = scan_points(field.grid, truth, np.random.default_rng(0))
    localiser.set_pose(truth, SURE)
    assert localiser.update(Pose2(0.0, 0.0, 0.0), points)
    assert localiser.update(Pose2(0.04, 0.0, 0.04), points) is None
    localiser.request_update()
    assert localiser.update(Pose2(0.04, 0.0, 0.04), points)
    assert localiser.update(Pose2(0.04, 0.0, 0.04), points) is None


def test_localiser_survives_a_scan_without_echoes(field: LikelihoodField) -> None:
    localiser = start(field)
    localiser.set_pose(Pose2(1.0, 0.0, 0.0), SURE)
    estimate = localiser.update(Pose2(0.0, 0.0, 0.0), np.empty((0, 2)))
    assert estimate
    assert math.dist(estimate.pose, (1.0, 0.0, 0.0)) < 0.05


def test_localiser_repeats_itself_with_the_same_seed(field: LikelihoodField) -> None:
    def run() -> list[ClusterEstimate | None]:
        localiser = start(field, seed=5)
        robot = Drifter(Pose2(1.0, -0.6, 0.0), np.random.default_rng(4))
        localiser.scatter()
        rng = np.random.default_rng(2)
        found = []
        for _ in range(5):
            robot.drive(0.1, 0.1)
            found.append(localiser.update(robot.odometry, scan_points(field.grid, robot.truth, rng)))
        return found

    assert [e and e.pose for e in run()] == [e and e.pose for e in run()]
