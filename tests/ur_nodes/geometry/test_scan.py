import math

import numpy as np
import pytest
from tests.ur_nodes.scans import FakeScan

from ur_nodes.costmap.layers import beams_of_scan
from ur_nodes.geometry.pose import make_pose3
from ur_nodes.geometry.scan import (
    SensorMount,
    classify_ranges,
    directions_of_scan,
    ends_of_beams,
    mount_of_pose,
    points_of_scan,
)
from ur_nodes.slam.matching.scan import make_scan

CENTRE = SensorMount(np.eye(3), np.zeros(3))


def quarters(*ranges: float) -> FakeScan:
    """Four beams: ahead, left, back, right."""
    return FakeScan(np.array(ranges, dtype=np.float32), 0.125, 10.0, 0.0, math.pi / 2.0)


@pytest.mark.parametrize(
    ("distance", "meaning"),
    [
        (1.0, "hit"),
        (0.125, "hit"),  # the lower limit
        (10.0, "clear"),  # the upper limit
        (11.0, "clear"),
        (math.inf, "clear"),
        (-math.inf, "near"),
        (math.nan, "nothing"),
        (0.1, "nothing"),
        (0.0, "nothing"),
        (-1.0, "nothing"),
    ],
)
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_ranges_mean_what_rep_117_says(distance: float, meaning: str, kind: type[np.floating]) -> None:
    returns = classify_ranges(np.array([distance], kind), (0.125, 10.0))
    found = {"hit": returns.hits, "clear": returns.clear, "near": returns.near}
    assert [name for name, mask in found.items() if mask[0]] == ([] if meaning == "nothing" else [meaning])


@pytest.mark.parametrize(
    ("distance", "point", "ray", "ray_if_inf_is_valid", "floor"),
    [
        (1.0, True, "hit", "hit", False),
        (10.0, False, None, None, True),
        (11.0, False, None, None, True),
        (math.inf, False, None, "free", True),
        (-math.inf, False, None, None, False),
        (math.nan, False, None, None, False),
        (0.1, False, None, None, False),
    ],
)
def test_localisation_costmaps_and_mapping_use_ranges(
    distance: float, point: bool, ray: str | None, ray_if_inf_is_valid: str | None, floor: bool
) -> None:
    """`point` of amcl and of a view; `ray` of a costmap; `floor` that mapping takes for free where it may."""
    scan = quarters(distance)
    assert len(points_of_scan(scan, CENTRE)) == point
    for valid, expected in ((False, ray), (True, ray_if_inf_is_valid)):
        beams = beams_of_scan(scan, inf_is_valid=valid)
        assert [("free", "hit")[int(hit)] for hit in beams.hits] == ([expected] if expected else [])
    mapped = make_scan(scan.ranges, directions_of_scan(scan), (0.125, 10.0), CENTRE, 5.0)
    assert (len(mapped.hits), mapped.misses.tolist()) == (int(point), [[5.0, 0.0]] if floor else [])


def test_points_allow_for_the_mount() -> None:
    half = math.sqrt(0.5)
    mount = mount_of_pose(make_pose3((0.2, 0.0, 0.3), (0.0, 0.0, half, half)))  # turned to the left
    points = points_of_scan(quarters(1.0, 2.0, 3.0, 4.0), mount)
    assert points == pytest.approx(np.array(((0.2, 1.0), (-1.8, 0.0), (0.2, -3.0), (4.2, 0.0))))


def test_points_are_mirrored_for_a_lidar_that_hangs_upside_down() -> None:
    mount = mount_of_pose(make_pose3((0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0)))  # rolled by half a turn
    points = points_of_scan(quarters(1.0, 2.0, 3.0, 4.0), mount)
    assert points == pytest.approx(np.array(((1.0, 0.0), (0.0, -2.0), (-3.0, 0.0), (0.0, 4.0))))


def test_points_keep_to_narrower_limits() -> None:
    assert points_of_scan(quarters(1.0, 2.0, 3.0, 4.0), CENTRE, (1.5, 3.0)) == pytest.approx(np.array(((0.0, 2.0),)))


def test_one_range_serves_for_many_beams() -> None:
    directions = directions_of_scan(quarters(1.0, 1.0, 1.0, 1.0))
    assert ends_of_beams(directions, 2.0, CENTRE) == pytest.approx(2.0 * directions)


def test_directions_of_one_geometry_are_computed_once_and_cannot_be_changed() -> None:
    directions = directions_of_scan(quarters(1.0, 2.0))
    assert directions_of_scan(quarters(3.0, 4.0)) is directions
    with pytest.raises(ValueError, match="read-only"):
        directions[0] = 0.0
