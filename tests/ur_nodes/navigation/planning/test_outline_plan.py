"""Paths for the outline of long robots."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.ur_nodes.navigation.closed_loop import LONG, MAGNI, STAGE, two_rooms

from ur_nodes.costmap.costmap import Costmap, Inflation, costs_of_grid, inflate
from ur_nodes.costmap.footprint import Footprint, footprint_of_outline
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.planning.global_plan import PlanSettings, plan_path, traversal_weights
from ur_nodes.navigation.planning.legs import Leg, bearing_of, legs_of_motions, points_of_legs
from ur_nodes.navigation.planning.outline_grid import overlaps
from ur_nodes.navigation.planning.outline_motions import MotionPose, Steering
from ur_nodes.navigation.planning.outline_plan import OutlinePath, OutlineRequest, fit_outline, is_long
from ur_nodes.navigation.planning.path_geometry import headings

WEIGHTS = traversal_weights(PlanSettings())


def robot() -> Footprint:
    return footprint_of_outline(LONG, 0.05, 0.01)


def rooms(footprint: Footprint) -> Costmap:
    grid = two_rooms()
    slopes = Inflation(footprint.inscribed, 0.55, 25.0)
    return Costmap(inflate(costs_of_grid(grid, lethal=65), 0.05, slopes), grid.resolution, grid.origin)


def plan(start: Pose2, goal: Pose2, heading: float | None) -> tuple[Costmap, OutlinePath]:
    costmap = rooms(robot())
    points = plan_path(costmap, (start.x, start.y), (goal.x, goal.y), PlanSettings())
    return costmap, fit_outline(OutlineRequest(costmap, WEIGHTS, points, robot(), start, heading, Steering()))


def poses_of(legs: tuple[Leg, ...]) -> NDArray[np.float64]:
    """The poses (n, 3) that the robot comes by, with those of its turns on the spot."""
    poses = []
    for leg in legs:
        if leg.turned is not None:
            bearing = bearing_of(leg)
            turns = np.linspace(bearing - leg.turned, bearing, 2 + math.ceil(abs(leg.turned) / 0.1))
            poses.append(np.column_stack((np.tile(leg.points[0], (len(turns), 1)), turns)))
        yaws = headings(leg.points) + (0.0 if leg.gear > 0 else math.pi)
        poses.append(np.column_stack((leg.points, yaws)))
    return np.concatenate(poses)


@pytest.mark.parametrize("heading", [1.57, 0.0, None])
def test_path_of_a_long_robot_through_a_door_beside_it_touches_nothing(heading: float | None) -> None:
    costmap, path = plan(Pose2(0.9, -1.0, 1.57), Pose2(2.4, -0.9, 0.0), heading)
    touched = overlaps(poses_of(path.legs), costmap, robot())
    assert (touched <= 2).all()  # at most a corner in the next cell
    end = points_of_legs(path.legs)[-1]
    assert math.dist(end, (2.4, -0.9)) < 0.1


def test_plain_path_of_the_same_robot_touches_the_door() -> None:
    costmap = rooms(robot())
    points = plan_path(costmap, (0.9, -1.0), (2.1, -0.9), PlanSettings())
    assert (overlaps(np.column_stack((points, headings(points))), costmap, robot()) > 0).any()


def test_path_that_the_outline_fits_on_stays_as_it_is() -> None:
    costmap = rooms(robot())
    points = plan_path(costmap, (-0.6, 0.0), (0.4, 0.0), PlanSettings())
    path = fit_outline(OutlineRequest(costmap, WEIGHTS, points, robot(), Pose2(-0.6, 0.0, 0.0), 0.0, Steering()))
    assert len(path.legs) == 1
    assert path.legs[0].points is points


def test_path_that_cannot_be_mended_is_kept() -> None:
    wide = footprint_of_outline(((0.9, 0.44), (-0.9, 0.44), (-0.9, -0.44), (0.9, -0.44)), 0.05)
    narrow = footprint_of_outline(((0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3)), 0.05)
    costmap = rooms(narrow)
    points = plan_path(costmap, (0.0, 0.0), (2.9, -0.9), PlanSettings())
    path = fit_outline(OutlineRequest(costmap, WEIGHTS, points, wide, Pose2(0.0, 0.0, 0.0), None, Steering()))
    assert points_of_legs(path.legs)[-1].tolist() == points[-1].tolist()


def test_robot_that_cannot_turn_on_the_spot_drives_back_and_forth_to_a_heading() -> None:
    car = footprint_of_outline(((0.45, 0.2), (-0.15, 0.2), (-0.15, -0.2), (0.45, -0.2)), 0.05, 0.01)
    costmap, start = rooms(car), Pose2(-0.6, 0.0, 1.57)
    points = plan_path(costmap, start[:2], (0.4, 0.9), PlanSettings())
    path = fit_outline(OutlineRequest(costmap, WEIGHTS, points, car, start, 3.0, Steering(0.6)))
    assert {leg.gear for leg in path.legs} == {1, -1}
    assert not any(leg.turned for leg in path.legs)
    assert math.dist(points_of_legs(path.legs)[-1], (0.4, 0.9)) < 0.06


def test_robot_that_cannot_turn_on_the_spot_has_no_path_where_it_does_not_fit() -> None:
    wide = footprint_of_outline(((0.9, 0.44), (-0.9, 0.44), (-0.9, -0.44), (0.9, -0.44)), 0.05)
    costmap = rooms(footprint_of_outline(((0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3)), 0.05))
    points = plan_path(costmap, (0.0, 0.0), (2.9, -0.9), PlanSettings())
    request = OutlineRequest(costmap, WEIGHTS, points, wide, Pose2(0.0, 0.0, 0.0), None, Steering(0.6))
    assert fit_outline(request).legs == ()


def test_robots_that_fit_through_doors_in_any_heading_are_not_long() -> None:
    assert is_long(robot())
    assert not is_long(footprint_of_outline(STAGE, 0.05))
    assert not is_long(footprint_of_outline(MAGNI, 0.05))


def test_motions_become_legs_with_turns_on_the_spot_between_them() -> None:
    ahead = [MotionPose(0.1 * step, 0.0, 0.0, 1) for step in range(1, 6)]
    turn = [MotionPose(0.5, 0.0, angle, 0) for angle in (0.5, 1.0, 1.57)]
    back = [MotionPose(0.5, -0.1 * step, 1.57, -1) for step in range(1, 4)]
    legs, left = legs_of_motions([MotionPose(0.0, 0.0, 0.0, 0), *ahead, *turn, *back, MotionPose(0.5, -0.3, 2.0, 0)])
    assert [leg.gear for leg in legs] == [1, -1]
    assert legs[0].turned is None
    assert legs[1].turned == pytest.approx(1.57)
    assert wrap_angle(bearing_of(legs[1]) - 1.57) == pytest.approx(0.0, abs=0.01)
    assert left == pytest.approx(0.43)
