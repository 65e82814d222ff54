import math

import numpy as np
import pytest

from ur_nodes.costmap.costmap import INSCRIBED, Costmap, Inflation, costs_of_grid, inflate
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.planning.global_plan import NoPathError, PlanSettings, path_is_free, plan_path
from ur_nodes.navigation.planning.path_geometry import Points, arc_lengths, curvatures, resample

INFLATION = Inflation(0.2, 0.55, 25.0)


def path_length(points: Points) -> float:
    return float(arc_lengths(points)[-1])


def costmap_of(values: np.ndarray) -> Costmap:
    grid = Grid(values.astype(np.int8), 0.05, Pose2(0.0, 0.0, 0.0))
    return Costmap(inflate(costs_of_grid(grid, lethal=65), 0.05, INFLATION), 0.05, grid.origin)


def room(width: float = 8.0, height: float = 6.0) -> np.ndarray:
    values = np.zeros((round(height / 0.05), round(width / 0.05)))
    values[[0, -1]] = 100
    values[:, [0, -1]] = 100
    return values


def with_wall(gap: float) -> np.ndarray:
    """A wall at x = 4 m from the bottom up, with a gap below the ceiling."""
    values = room()
    values[: round((6.0 - gap) / 0.05), 79:81] = 100
    return values


@pytest.mark.parametrize("goal", [(7.0, 5.0), (7.0, 1.0), (1.5, 5.2), (6.13, 3.37)])
def test_plan_path_is_straight_where_nothing_is_in_the_way(goal: tuple[float, float]) -> None:
    path = plan_path(costmap_of(room()), (1.0, 1.0), goal, PlanSettings())
    assert path[0].tolist() == pytest.approx([1.0, 1.0])
    assert path[-1].tolist() == pytest.approx(list(goal))
    assert path_length(path) <= 1.002 * math.dist((1.0, 1.0), goal)


def test_plan_path_round_a_wall_is_near_the_shortest_and_keeps_clear() -> None:
    costmap = costmap_of(with_wall(2.0))
    path = plan_path(costmap, (2.0, 1.0), (6.0, 1.0), PlanSettings())
    # A taut string round the wall's end at the inscribed radius: straight to that circle, along it, across, and down.
    away = math.dist((2.0, 1.0), (3.975, 3.975))
    turn = math.pi - math.atan2(1.975, 2.975) - math.acos(0.2 / away)
    shortest = 2 * math.sqrt(away**2 - 0.2**2) + 2 * 0.2 * turn + 0.05
    assert 0.995 * shortest < path_length(path) <= 1.05 * shortest
    assert (costmap.costs_at(path) < INSCRIBED).all()


def test_plan_path_bends_no_more_than_the_robot_can_drive_briskly() -> None:
    path = plan_path(costmap_of(with_wall(2.0)), (2.0, 1.0), (6.0, 1.0), PlanSettings())
    assert abs(curvatures(path, 3)).max() < 3.0


def test_plan_path_points_are_evenly_spaced() -> None:
    path = plan_path(costmap_of(with_wall(2.0)), (2.0, 1.0), (6.0, 1.0), PlanSettings(spacing=0.05))
    steps = np.diff(arc_lengths(path))
    assert steps.min() > 0.045
    assert steps.max() < 0.055


def test_plan_path_works_in_a_turned_map() -> None:
    plain = costmap_of(with_wall(2.0))
    turned = Costmap(plain.costs, plain.resolution, Pose2(3.0, -1.0, 0.6))
    ends = turned.points_of_cells(plain.fractions_of_points(np.array([(2.0, 1.0), (6.0, 1.0)])) - 0.5)
    path = plan_path(turned, tuple(ends[0]), tuple(ends[1]), PlanSettings())
    straight = plan_path(plain, (2.0, 1.0), (6.0, 1.0), PlanSettings())
    assert path_length(path) == pytest.approx(path_length(straight), rel=0.01)


@pytest.mark.parametrize(
    ("goal", "reason"),
    [
        ((4.0, 2.0), r"the goal \(4\.00, 2\.00\) is in a wall or an obstacle"),
        ((4.15, 2.0), r"the goal \(4\.15, 2\.00\) is so near to a wall or an obstacle that the robot does not fit"),
        ((9.0, 2.0), r"the goal \(9\.00, 2\.00\) is outside the map"),
    ],
)
def test_plan_path_says_why_a_goal_is_bad(goal: tuple[float, float], reason: str) -> None:
    with pytest.raises(NoPathError, match=reason):
        plan_path(costmap_of(with_wall(2.0)), (1.0, 1.0), goal, PlanSettings())


def test_plan_path_says_that_a_gap_is_too_narrow() -> None:
    with pytest.raises(NoPathError, match=r"nothing wide enough .* \(6\.00, 1\.00\)"):
        plan_path(costmap_of(with_wall(0.35)), (2.0, 1.0), (6.0, 1.0), PlanSettings())


def test_plan_path_does_not_enter_unknown_space_unless_allowed() -> None:
    values = room()
    values[:, 60:100] = -1
    with pytest.raises(NoPathError, match="nothing wide enough"):
        plan_path(costmap_of(values), (1.0, 1.0), (7.0, 1.0), PlanSettings())
    assert len(plan_path(costmap_of(values), (1.0, 1.0), (7.0, 1.0), PlanSettings(allow_unknown=True)))


def test_plan_path_leads_out_of_a_place_too_near_to_a_wall() -> None:
    path = plan_path(costmap_of(room()), (0.15, 3.0), (5.0, 3.0), PlanSettings())
    assert path[0].tolist() == pytest.approx([0.15, 3.0])
    assert path[-1].tolist() == pytest.approx([5.0, 3.0])


def test_plan_path_with_tolerance_ends_beside_a_goal_that_is_taken() -> None:
    path = plan_path(costmap_of(with_wall(2.0)), (1.0, 1.0), (4.0, 2.0), PlanSettings(tolerance=0.5))
    assert 0.0 < math.dist(path[-1], (4.0, 2.0)) <= 0.5


def test_plan_path_moves_a_goal_without_room_to_turn_by_no_more_than_allowed() -> None:
    settings = PlanSettings(nudge=0.05, room=0.31)
    near_wall = plan_path(costmap_of(room()), (2.0, 2.0), (0.28, 3.0), settings)
    assert near_wall[-1].tolist() == pytest.approx([0.33, 3.0], abs=0.02)
    free = plan_path(costmap_of(room()), (2.0, 2.0), (3.0, 3.0), settings)
    assert free[-1].tolist() == pytest.approx([3.0, 3.0])


def test_path_is_free_notices_a_new_obstacle() -> None:
    values = room()
    path = plan_path(costmap_of(values), (1.0, 3.0), (7.0, 3.0), PlanSettings())
    assert path_is_free(costmap_of(values), path)
    values[58:62, 78:82] = 100
    assert not path_is_free(costmap_of(values), path)


def test_curvatures_of_a_circle_are_one_over_its_radius() -> None:
    angles = np.linspace(0.0, 3.0, 200)
    circle = resample(np.stack((0.8 * np.cos(angles), 0.8 * np.sin(angles)), axis=-1), 0.05)
    assert curvatures(circle) == pytest.approx(1.25, rel=0.01)
    assert curvatures(circle[::-1]) == pytest.approx(-1.25, rel=0.01)
