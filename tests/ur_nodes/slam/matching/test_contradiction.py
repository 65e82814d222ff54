import math

import numpy as np
from tests.ur_nodes.slam.rooms import CENTRE, ROOM, box, scan_at, walls_of

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.match import contradiction
from ur_nodes.slam.matching.scan import make_scan

HERE = Pose2(0.0, 0.0, 0.0)
HALL = walls_of(box(-6.0, -6.0, 6.0, 6.0))
CELL = walls_of(box(-2.0, -2.0, 2.0, 2.0))


def test_scan_of_the_same_place_contradicts_nothing() -> None:
    target = scan_at(ROOM, HERE, 0.01).surface
    assert contradiction(target, scan_at(ROOM, Pose2(0.2, 0.1, 0.3), 0.01, seed=1), Pose2(0.2, 0.1, 0.3)) < 0.02


def test_beams_that_pass_all_walls_of_the_map_contradict_it_wholly() -> None:
    assert contradiction(scan_at(CELL, HERE).surface, scan_at(HALL, HERE), HERE) == 1.0


def test_walls_behind_what_a_scan_sees_are_out_of_sight() -> None:
    assert contradiction(scan_at(HALL, HERE).surface, scan_at(CELL, HERE), HERE) == 0.0


def test_scan_without_points_contradicts_the_map() -> None:
    empty = make_scan(np.full(4, np.inf), np.zeros((4, 2)), (0.1, 10.0), CENTRE)
    assert contradiction(scan_at(CELL, HERE).surface, empty, HERE) == 1.0


def test_surface_that_is_hardly_in_sight_explains_no_scan() -> None:
    behind = Pose2(1.5, 0.0, math.pi)
    ahead = scan_at(HALL, HERE, view=1.0).surface
    assert contradiction(ahead, scan_at(HALL, behind, view=1.0), behind) == 0.0
    assert contradiction(ahead, scan_at(HALL, behind, view=1.0), behind, 0.3) == 1.0
