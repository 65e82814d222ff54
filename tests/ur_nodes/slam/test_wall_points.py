import numpy as np
import pytest
from tests.ur_nodes.slam.rooms import CENTRE, box, scan_at, walls_of

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.scan import MapScan, make_scan
from ur_nodes.slam.occupancy import wall_points

ROOM = walls_of(box(-2.0, -1.5, 2.0, 1.5))


def ahead(scan: MapScan) -> np.ndarray:
    """The beams that end on the wall ahead, at x = 2 m, away from its corners."""
    return (scan.hits[:, 0] > 1.8) & (np.abs(scan.hits[:, 1]) < 1.0)


def test_points_lie_behind_the_surface_of_a_wall_seen_from_anywhere() -> None:
    scan = scan_at(ROOM, Pose2(0.0, 0.0, 0.0))
    assert wall_points(scan, 0.03)[ahead(scan), 0] == pytest.approx(2.03, abs=0.001)


def test_noise_of_neighbours_is_averaged() -> None:
    scan = scan_at(ROOM, Pose2(0.0, 0.0, 0.0), noise=0.01)
    seen = ahead(scan)
    assert np.std(wall_points(scan, 0.03)[seen, 0]) < 0.6 * np.std(scan.hits[seen, 0])


def test_lone_point_stays_where_it_was_seen() -> None:
    pole = walls_of(box(1.0, -0.005, 1.01, 0.005))
    scan = scan_at(pole, Pose2(0.0, 0.0, 0.0))
    assert len(scan.hits) == 1
    assert wall_points(scan, 0.03) == pytest.approx(scan.hits)


def test_scan_without_hits_has_no_points() -> None:
    scan = make_scan(np.full(4, np.inf), np.eye(4)[:, :2], (0.1, 10.0), CENTRE)
    assert wall_points(scan, 0.03).shape == (0, 2)


def test_scan_with_more_beams_than_are_matched_has_a_point_for_each() -> None:
    angles = np.linspace(-0.5, 0.5, 1001)
    directions = np.column_stack((np.cos(angles), np.sin(angles)))
    scan = make_scan(2.0 / directions[:, 0], directions, (0.1, 10.0), CENTRE)
    assert len(scan.facing) < len(scan.hits) == 1001
    assert wall_points(scan, 0.03)[:, 0] == pytest.approx(2.03, abs=0.002)
