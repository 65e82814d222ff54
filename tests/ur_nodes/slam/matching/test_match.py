import math

import numpy as np
import pytest
from tests.ur_nodes.slam.rooms import CENTRE, CORRIDOR, DIRECTIONS, ROOM, Floats, box, ranges_at, scan_at, walls_of

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.match import locate_surface, match_surface
from ur_nodes.slam.matching.scan import make_scan
from ur_nodes.slam.matching.surface import Surface
from ur_nodes.slam.prediction import UNKNOWN_MOTION

HERE = Pose2(0.0, 0.0, 0.0)


def local_map(walls: Floats) -> LocalMap:
    return LocalMap([(HERE, scan_at(walls, HERE, 0.01).surface)])


@pytest.mark.parametrize("true", [Pose2(0.11, -0.07, 0.05), Pose2(-0.2, 0.1, -0.12), Pose2(0.0, 0.0, 0.2)])
def test_known_displacement_is_found_to_millimetres(true: Pose2) -> None:
    found = match_surface(local_map(ROOM), scan_at(ROOM, true, 0.01, seed=1).surface, HERE)
    assert math.hypot(found.pose.x - true.x, found.pose.y - true.y) < 0.006
    assert found.pose.yaw == pytest.approx(true.yaw, abs=0.003)
    assert found.agreement > 0.9
    assert math.sqrt(float(np.linalg.eigvalsh(found.covariance[:2, :2])[-1])) < 0.01


def test_covariance_in_a_corridor_is_large_along_it_and_small_across() -> None:
    true = Pose2(0.0, 0.08, 0.03)
    found = match_surface(local_map(CORRIDOR), scan_at(CORRIDOR, true, 0.01, seed=1).surface, HERE)
    along, across = math.sqrt(found.covariance[0, 0]), math.sqrt(found.covariance[1, 1])
    assert along > 5.0
    assert across < 0.01
    assert found.pose.y == pytest.approx(true.y, abs=0.006)
    assert found.pose.yaw == pytest.approx(true.yaw, abs=0.003)


def test_guess_decides_along_a_corridor() -> None:
    guess, true = Pose2(0.3, 0.0, 0.0), Pose2(0.3, 0.05, 0.02)
    prior = np.diag(np.square((0.1, 0.1, 0.1)))
    found = match_surface(local_map(CORRIDOR), scan_at(CORRIDOR, true, 0.01, seed=1).surface, guess, prior)
    assert found.pose.x == pytest.approx(0.3, abs=0.002)
    assert found.pose.y == pytest.approx(0.05, abs=0.006)


def test_sides_of_a_thin_wall_are_not_confused() -> None:
    walls = np.array([[(-3.0, 0.0), (3.0, 0.0)], [(-3.0, 0.06), (3.0, 0.06)], [(-3.0, -2.0), (-3.0, 2.0)]])
    north, south = Pose2(0.0, 1.0, 0.0), Pose2(0.0, -1.0, 0.0)
    target = LocalMap([(north, scan_at(walls, north).surface)])
    found = match_surface(target, scan_at(walls, south).surface, south, np.diag(np.square((0.1, 0.1, 0.05))))
    assert found.pose.y == pytest.approx(-1.0, abs=0.005)


def test_scan_of_another_place_agrees_little() -> None:
    elsewhere = np.vstack((ROOM + np.array((6.0, 1.5)), CORRIDOR + np.array((0.0, 7.0))))
    found = match_surface(local_map(ROOM), scan_at(elsewhere, Pose2(7.0, 2.0, 1.0)).surface, HERE)
    assert found.agreement < 0.5


def test_walls_of_a_hall_count_although_beams_hit_them_far_apart() -> None:
    hall = walls_of(box(-18.0, -14.0, 25.0, 16.0), box(-9.0, 6.0, -8.2, 6.8), box(12.0, -7.0, 13.0, -6.0))
    target = LocalMap([(HERE, scan_at(hall, HERE, 0.01, reach=50.0).surface)])
    true = Pose2(0.9, -0.4, 0.06)
    found = match_surface(target, scan_at(hall, true, 0.01, seed=1, reach=50.0).surface, Pose2(0.8, -0.3, 0.04))
    assert math.hypot(found.pose.x - true.x, found.pose.y - true.y) < 0.02
    assert found.pose.yaw == pytest.approx(true.yaw, abs=0.002)
    assert found.agreement > 0.8


def test_doorway_of_a_far_wall_is_not_filled_up() -> None:
    walls = np.array([[(-12.0, 14.0), (-1.0, 14.0)], [(1.0, 14.0), (12.0, 14.0)]])
    target = LocalMap([(HERE, scan_at(walls, HERE, reach=50.0).surface)])
    across = target.surface.points[:, 0]
    assert np.diff(np.sort(across)).max() > 1.8
    beside = np.sort(across[(across > 1.4) & (across < 6.0)])
    assert np.diff(beside).max() < 0.15


def scan_among_people(true: Pose2) -> Surface:
    """The surface of a scan of which about half is people near by."""
    random = np.random.default_rng(3)
    ranges = ranges_at(ROOM, true, 0.01, seed=1)
    people = random.random(len(ranges)) < 0.55
    ranges[people] = random.uniform(0.3, 1.0, int(people.sum()))
    return make_scan(ranges, DIRECTIONS, (0.1, 12.0), CENTRE).surface


def test_turn_that_odometry_reports_is_believed_where_a_scan_fits_only_a_little_without_it() -> None:
    crowd = scan_among_people(HERE)
    guess = Pose2(0.1, 0.0, 1.0)
    prior, spread = np.diag(np.square((0.02, 0.02, 0.05))), np.diag(np.square((0.1, 0.1, 0.15)))
    found = locate_surface(local_map(ROOM), crowd, guess, prior, HERE, spread)
    assert 0.3 < match_surface(local_map(ROOM), crowd, HERE, spread).agreement < 0.6
    assert found.pose.yaw == pytest.approx(guess.yaw, abs=0.2)


def test_search_that_ends_far_from_odometry_with_little_agreement_is_not_believed() -> None:
    crowd = scan_among_people(Pose2(0.18, 0.15, 0.0))
    prior = np.diag(np.square((0.01, 0.01, 0.01)))
    found = locate_surface(local_map(ROOM), crowd, HERE, prior, HERE, prior)
    assert math.hypot(found.pose.x, found.pose.y) < 0.1


def test_person_who_walks_beside_the_robot_along_a_corridor_does_not_stop_it() -> None:
    true, guess = Pose2(0.8, 0.0, 0.0), Pose2(0.8, 0.06, 0.0)
    person = walls_of(box(4.0, 0.6, 4.1, 0.7))
    seen = [(HERE, scan_at(np.vstack((CORRIDOR, person)), HERE)), (true, scan_at(CORRIDOR, true))]
    local = LocalMap([(pose, scan.surface) for pose, scan in seen])
    scan = scan_at(np.vstack((CORRIDOR, person + np.array((true.x, 0.0)))), true, 0.01, seed=1, reach=10.0)
    prior = np.diag(np.square((0.02, 0.02, 0.02)))
    assert match_surface(local, scan.surface, guess, prior).agreement < 1.0
    found = locate_surface(local, scan.surface, guess, prior, HERE, UNKNOWN_MOTION)
    assert found.pose.x == pytest.approx(true.x, abs=0.1)
