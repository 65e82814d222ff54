import math

import numpy as np
import pytest

from ur.source.diagnostic import UserError
from ur_nodes.costmap.costmap import LETHAL, Inflation
from ur_nodes.costmap.layers import Beams, UsedRanges
from ur_nodes.costmap.map_costmap import MapCostmap
from ur_nodes.costmap.rolling_costmap import RollingCostmap
from ur_nodes.costmap.touched import BumperSource, TouchMarks, read_bumpers, touched_points
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus

SQUARE = np.array(((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)))
FRONT = BumperSource("front", -math.pi / 4, math.pi / 4)
MARK = np.array(((1.0, 0.0),))
ORIGIN = Pose2(0.0, 0.0, 0.0)


def test_bumper_layer_names_a_sector_for_each_topic() -> None:
    bus = Bus()
    bus.load_parameters("/node/bumper_layer", {"topics": ["front"], "sectors": [[-0.5, 0.5]]})
    assert read_bumpers(bus.node("node").parameters.below("bumper_layer")) == (BumperSource("front", -0.5, 0.5),)
    bus.load_parameters("/other/bumper_layer", {"topics": ["front", "back"], "sectors": [[-0.5, 0.5]]})
    with pytest.raises(UserError, match="of the 2 topics"):
        read_bumpers(bus.node("other").parameters.below("bumper_layer"))


def rays(length: float, *, hits: bool = True) -> Beams:
    angles = np.linspace(-math.pi, math.pi, 360, endpoint=False)
    return Beams(angles, np.full(360, length), np.full(360, hits))


def test_motion_ahead_touches_what_is_before_the_outline() -> None:
    points = touched_points(SQUARE, (0.3, 0.0, 0.0))
    assert points[:, 0] == pytest.approx(0.23, abs=0.001)
    assert (points[:, 1].min(), points[:, 1].max()) == pytest.approx((-0.2, 0.2), abs=0.03)


def test_motion_to_the_left_touches_what_is_on_the_left() -> None:
    assert touched_points(SQUARE, (0.0, 0.0, 0.3))[:, 1] == pytest.approx(0.23, abs=0.001)


def test_turn_touches_half_of_each_side() -> None:
    points = touched_points(SQUARE, (0.0, 1.0, 0.0))
    front = points[points[:, 0] > 0.22]
    assert len(front)
    assert front[:, 1].max() < 0.0, "its right end swings ahead"


def test_bumper_touches_within_its_sector_even_of_a_robot_at_rest() -> None:
    points = touched_points(SQUARE, (0.0, 0.0, 0.0), FRONT)
    assert np.median(points[:, 0]) == pytest.approx(0.23)
    assert points[:, 0].min() > 0.19


def test_wider_marks_go_on_to_both_sides_and_never_into_the_robot() -> None:
    points = touched_points(SQUARE, (0.3, 0.0, 0.0), FRONT, widen=0.3)
    assert (points[:, 1].min(), points[:, 1].max()) == pytest.approx((-0.5, 0.5), abs=0.05)
    assert points[:, 0].min() > 0.2
    assert points[np.abs(points[:, 1]) > 0.4, 0].max() == pytest.approx(0.35), "no path turns close round its ends"


def test_unseen_marks_are_kept_for_ever() -> None:
    marks = TouchMarks()
    marks.add(MARK)
    for _ in range(1000):
        assert not marks.look(ORIGIN, 0.3, ORIGIN, rays(0.5), 0.5)  # something hides the place
        assert not marks.look(Pose2(0.7, 0.0, 0.0), 0.3, ORIGIN, rays(3.0), 0.5)  # the robot is at it
    assert len(marks.points) == 1


def test_mark_that_the_lidar_sees_through_is_forgotten_after_a_minute_in_view() -> None:
    marks = TouchMarks()
    marks.add(MARK)
    views = next(count for count in range(1, 1000) if marks.look(ORIGIN, 0.3, ORIGIN, rays(3.0), 0.5))
    assert views * 0.5 == pytest.approx(60.0)
    assert not len(marks.points)


def test_mark_where_something_was_seen_is_forgotten_as_soon_as_that_has_left() -> None:
    marks = TouchMarks()
    marks.add(MARK)
    marks.look(ORIGIN, 0.3, ORIGIN, rays(1.05), 0.1)
    views = next(count for count in range(1, 1000) if marks.look(ORIGIN, 0.3, ORIGIN, rays(3.0, hits=False), 0.1))
    assert views <= 11


def test_mark_that_is_touched_again_counts_anew() -> None:
    marks = TouchMarks()
    marks.add(MARK)
    for _ in range(100):
        marks.look(ORIGIN, 0.3, ORIGIN, rays(3.0), 0.5)
    marks.add(MARK)
    assert len(marks.points) == 1
    assert not marks.look(ORIGIN, 0.3, ORIGIN, rays(3.0), 30.0)


def test_rays_clear_no_touched_cell_of_the_local_costmap() -> None:
    costmap = RollingCostmap(4.0, 0.05, UsedRanges(2.5, 3.0), Inflation(0.2, 0.5, 10.0))
    costmap.update(ORIGIN, ORIGIN, rays(2.0))
    costmap.touched = np.concatenate((MARK, ((9.0, 9.0),)))
    costmap.update(ORIGIN, ORIGIN, rays(2.0))
    assert costmap.occupied().costs_at(MARK).tolist() == [LETHAL]


def test_global_costmap_shows_touched_cells_until_they_are_taken_back() -> None:
    grid = Grid(np.zeros((80, 80), np.int8), 0.05, Pose2(-2.0, -2.0, 0.0))
    costmap = MapCostmap(grid, UsedRanges(2.5, 3.0), Inflation(0.2, 0.5, 10.0), lethal=65, track_unknown=True)
    before = costmap.costmap.costs.copy()
    costmap.touch(MARK)
    costmap.update(ORIGIN, rays(3.0))
    assert costmap.costmap.costs_at(MARK).tolist() == [LETHAL]
    assert costmap.static.costs_at(MARK).tolist() == [0]
    assert np.array_equal(costmap.untouched().costs, before)
    other = MapCostmap(grid, UsedRanges(2.5, 3.0), costmap.inflation, lethal=65, track_unknown=True)
    other.mark_like(costmap)
    assert np.array_equal(other.costmap.costs, costmap.costmap.costs)
    costmap.touch(np.empty((0, 2)))
    assert np.array_equal(costmap.costmap.costs, before)
