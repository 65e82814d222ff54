import numpy as np
import pytest
from tests.ur_nodes.navigation.synthetic import make_room, scan_points

from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.localiser import LOST, PoseFit, share_through_walls, step_doubt

HERE = Pose2(1.0, -0.6, 0.0)


def test_scan_at_its_own_pose_passes_no_wall() -> None:
    grid = make_room()
    assert share_through_walls(grid, HERE, scan_points(grid, HERE, np.random.default_rng(0))) < 0.03


def test_scan_of_another_place_passes_walls() -> None:
    grid = make_room()
    points = scan_points(grid, Pose2(5.5, 2.5, -2.0), np.random.default_rng(0))
    assert share_through_walls(grid, HERE, points) > 0.3


def test_beams_that_end_before_the_wall_pass_none() -> None:
    grid = make_room()
    points = scan_points(grid, HERE, np.random.default_rng(0))
    assert share_through_walls(grid, HERE, 0.5 * points) < 0.02
    assert share_through_walls(grid, HERE, np.zeros((0, 2))) == 0.0


@pytest.mark.parametrize(
    ("fit", "scans"),
    [
        (PoseFit(agreement=0.1, through=0.4), 4),  # carried away
        (PoseFit(agreement=0.1, through=0.0), 27),  # a crowd, or a closet
        (PoseFit(agreement=0.3, through=0.1), None),  # many people
        (PoseFit(agreement=0.6, through=0.4), None),  # walls of the map have been taken out
    ],
)
def test_scans_that_look_through_walls_are_doubted_soon_and_crowds_late_or_never(
    fit: PoseFit, scans: int | None
) -> None:
    doubt, needed = 0.0, None
    for number in range(1, 200):
        doubt = step_doubt(doubt, fit)
        if doubt >= LOST:
            needed = number
            break
    assert needed == scans


def test_scan_that_fits_again_takes_doubt_away() -> None:
    assert step_doubt(3.0, PoseFit(0.9, 0.0)) == 2.0
    assert step_doubt(0.0, PoseFit(0.9, 0.0)) == 0.0
