import math

import numpy as np
import pytest
from tests.ur_nodes.scans import FakeScan

from ur_nodes.costmap.costmap import LETHAL, Costmap, Inflation
from ur_nodes.costmap.layers import Beams, UsedRanges, beams_of_scan, shift_cells, trace_beams
from ur_nodes.costmap.map_costmap import MapCostmap
from ur_nodes.costmap.rolling_costmap import RollingCostmap
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

HERE = Pose2(0.0, 0.0, 0.0)
INFLATION = Inflation(0.2, 0.5, 10.0)


def frame(cells: int = 101) -> tuple[np.ndarray, Costmap]:
    """Cells of 0.1 m with the middle of the middle one at (0, 0)."""
    occupied = np.zeros((cells, cells), bool)
    corner = -0.1 * cells / 2
    return occupied, Costmap(occupied.view(np.uint8), 0.1, Pose2(corner, corner, 0.0))


def one_beam(angle: float, distance: float, hit: bool = True) -> Beams:
    return Beams(np.array([angle]), np.array([distance]), np.array([hit]))


def test_trace_beams_marks_where_a_ray_ends() -> None:
    occupied, place = frame()
    box = trace_beams(occupied, place, HERE, one_beam(0.0, 2.0), UsedRanges(2.5, 3.0))
    assert np.argwhere(occupied).tolist() == [[50, 70]]
    assert box == (slice(50, 51), slice(70, 71))


def test_trace_beams_clears_what_a_ray_passes_and_not_what_is_behind() -> None:
    occupied, place = frame()
    occupied[50, 55:80] = True
    trace_beams(occupied, place, HERE, one_beam(0.0, 2.0), UsedRanges(2.5, 3.0))
    assert not occupied[50, 55:70].any()
    assert occupied[50, 70:80].all()


@pytest.mark.parametrize("degrees", range(0, 360, 15))
def test_trace_beams_clears_every_cell_that_a_ray_crosses_well(degrees: int) -> None:
    occupied, place = frame()
    occupied[:] = True
    angle = math.radians(degrees)
    trace_beams(occupied, place, HERE, one_beam(angle, 2.0, hit=False), UsedRanges(2.5, 3.0))
    along = np.arange(0.0, 1.85, 0.07)[:, None] * (math.cos(angle), math.sin(angle))
    cells = np.floor(place.fractions_of_points(along)).astype(int)
    assert not occupied[cells[:, 0], cells[:, 1]].any()
    assert (~occupied).sum() <= 42  # 2 m of cells of 0.1 m: at the most about two beside each other


def test_trace_beams_keeps_to_its_ranges() -> None:
    occupied, place = frame()
    occupied[50, 85] = True
    trace_beams(occupied, place, HERE, one_beam(0.0, 4.0), UsedRanges(2.5, 3.0))
    assert np.argwhere(occupied).tolist() == [[50, 85]], "too far to mark, too far to clear"


def test_trace_beams_does_not_mark_what_is_to_be_ignored() -> None:
    occupied, place = frame()
    ranges = UsedRanges(2.5, 3.0)
    trace_beams(occupied, place, HERE, one_beam(0.0, 2.0), ranges, ignore=lambda cells: np.ones(len(cells), bool))
    assert not occupied.any()


def test_trace_beams_reports_no_change_for_the_same_scan_again() -> None:
    occupied, place = frame()
    beams = Beams(np.linspace(-3, 3, 90), np.full(90, 1.7), np.ones(90, bool))
    assert trace_beams(occupied, place, HERE, beams, UsedRanges(2.5, 3.0)) is not None
    assert trace_beams(occupied, place, HERE, beams, UsedRanges(2.5, 3.0)) is None


def test_beams_of_scan_reads_infinity_as_free_only_when_told() -> None:
    scan = FakeScan(np.array([1.0, math.inf, math.nan, 0.01, 30.0, -math.inf]))
    strict = beams_of_scan(scan, inf_is_valid=False)
    assert strict.ranges.tolist() == [1.0]
    wide = beams_of_scan(scan, inf_is_valid=True)
    assert wide.ranges.tolist() == [1.0, 12.0]
    assert wide.hits.tolist() == [True, False]


def test_shift_cells_moves_the_window_not_the_world() -> None:
    occupied = np.zeros((6, 6), bool)
    occupied[3, 4] = True
    assert np.argwhere(shift_cells(occupied, 1, -1)).tolist() == [[2, 5]]
    assert not shift_cells(occupied, 9, 0).any()


def test_rolling_costmap_keeps_an_obstacle_in_its_place_while_it_rolls() -> None:
    costmap = RollingCostmap(4.0, 0.05, UsedRanges(2.5, 3.0), INFLATION)
    nothing = Beams(np.empty(0), np.empty(0), np.empty(0, bool))
    costmap.update(HERE, HERE, one_beam(0.0, 1.0))
    for x in np.arange(0.0, 0.8, 0.03):
        costmap.update(Pose2(float(x), 0.0, 0.0), HERE, nothing)
        assert costmap.occupied().costs_at(np.array((1.001, 0.001))) == LETHAL
    costmap.clear()
    assert not costmap.occupied().costs.any()


def test_rolling_costmap_without_a_scan_shows_the_map_where_the_localiser_says_it_lies() -> None:
    values = np.zeros((60, 60), np.int8)
    values[:, 40] = 100  # a wall across x, 2.0 to 2.05 m
    known = MapCostmap(Grid(values, 0.05, HERE), UsedRanges(0.0, 0.0), INFLATION, lethal=65, track_unknown=True).static
    costmap = RollingCostmap(4.0, 0.05, UsedRanges(0.0, 0.0), INFLATION)
    quarter = Pose2(1.0, -1.0, math.pi / 2)  # the map's x axis is the window's y axis
    costmap.overlay(Pose2(0.0, 0.5, 0.0), known, quarter)
    costmap.clear()
    assert costmap.occupied().costs_at(np.array((0.0, 1.02))) == LETHAL
    assert costmap.occupied().costs_at(np.array((0.0, 0.9))) != LETHAL
    costmap.overlay(Pose2(0.0, 0.5, 0.0), known, Pose2(1.0, -1.1, math.pi / 2))
    assert costmap.occupied().costs_at(np.array((0.0, 0.92))) == LETHAL
    assert costmap.occupied().costs_at(np.array((0.0, 1.02))) != LETHAL


def test_map_costmap_takes_a_wall_seen_from_a_wrong_pose_for_the_wall() -> None:
    values = np.zeros((60, 60), np.int8)
    values[:, 40] = 100
    costmap = MapCostmap(Grid(values, 0.05, HERE), UsedRanges(2.5, 3.0), INFLATION, lethal=65, track_unknown=True)
    assert not costmap.update(Pose2(1.0, 1.5, 0.0), one_beam(0.0, 0.92))
    assert costmap.update(Pose2(1.0, 1.5, 0.0), one_beam(0.0, 0.5))
    assert costmap.costmap.costs_at(np.array((1.5, 1.501))) == LETHAL
    costmap.clear(Pose2(1.0, 1.5, 0.0), 1.0)
    assert costmap.costmap.costs_at(np.array((1.5, 1.501))) == LETHAL, "near the robot it stays"
    costmap.clear()
    assert (costmap.costmap.costs == costmap.static.costs).all()


def test_zone_is_an_obstacle_of_the_plan_until_it_is_taken_away() -> None:
    grid = Grid(np.zeros((60, 60), np.int8), 0.05, HERE)
    costmap = MapCostmap(grid, UsedRanges(2.5, 3.0), INFLATION, lethal=65, track_unknown=True)
    free = costmap.costmap.costs.copy()
    mask = Grid(np.full((20, 10), 100, np.int8), 0.1, Pose2(1.0, 2.0, -math.pi / 2))  # turned, and of larger cells
    costmap.forbid(mask)
    inside, beside = np.array((2.0, 1.6)), np.array((2.0, 0.9))
    for costs in (costmap.static, costmap.costmap):
        assert costs.costs_at(inside) == LETHAL
        assert costs.costs_at(beside) == 253
    assert costmap.walls.costs_at(inside) == 0
    assert costmap.zones is not None
    assert int((costmap.zones.costs == LETHAL).sum()) == 40 * 20
    assert costmap.update(Pose2(0.5, 1.5, 0.0), one_beam(0.0, 0.6)), "what is seen in a zone is marked as elsewhere"
    assert costmap.update(Pose2(0.5, 1.5, 0.0), one_beam(0.0, 2.0, hit=False))
    assert costmap.costmap.costs_at(inside) == LETHAL, "no ray clears a zone"
    costmap.forbid(Grid(np.full((5, 5), 100, np.int8), 0.1, Pose2(0.1, 0.1, 0.0)))
    assert costmap.costmap.costs_at(inside) == 0
    assert costmap.costmap.costs_at(np.array((0.3, 0.3))) == LETHAL
    costmap.forbid(Grid(np.full((5, 5), 100, np.int8), 0.1, Pose2(50.0, 50.0, 0.0)))
    assert costmap.zones is None
    assert (costmap.costmap.costs == free).all()
    assert (costmap.static.costs == free).all()
