import numpy as np
from tests.ur_nodes.exploration.drawn import ROOM, box, draw, place

from ur_nodes.exploration.explorer import Reason, explain_unreachable
from ur_nodes.exploration.search.floor import read_floor
from ur_nodes.exploration.search.frontiers import find_frontiers
from ur_nodes.geometry.grid import Grid

GLASS = "?????????\n#######??\n#....#..?\n#....#..?\n#######??\n?????????"


def explain(grid: Grid, radius: float, obstacles: np.ndarray | None = None) -> Reason:
    floor = read_floor(grid, place(2, 3), radius, obstacles)
    frontier = max(find_frontiers(floor, 0.3), key=lambda each: each.point[0])
    return explain_unreachable(floor, frontier, grid.values >= 65)


def test_narrow_door_is_named_with_its_width_and_the_width_of_the_robot() -> None:
    reason = explain(draw(ROOM), 0.5)
    assert reason.kind == "narrow"
    assert abs(reason.point[0] - place(8, 4).x) < 0.3
    assert "too narrow at (3." in reason.text
    assert reason.text.endswith(": 0.75 m < 1.00 m")


def test_floor_that_the_lidar_sees_through_a_wall_is_behind_glass() -> None:
    floor = read_floor(draw(GLASS), place(2, 2, GLASS), 0.2)
    (frontier,) = find_frontiers(floor, 0.3)
    reason = explain_unreachable(floor, frontier)
    assert reason.kind == "behind"
    assert reason.text.startswith("behind the glass or through a gap at (2.")


def test_obstacle_that_only_sensors_see_is_told_from_a_wall_of_the_map() -> None:
    door = place(8, 4.5)
    reason = explain(draw(ROOM), 0.2, box(door.x - 0.1, door.y - 0.45, door.x + 0.1, door.y + 0.45))
    assert reason.kind == "obstacle"
    assert reason.text.startswith("behind an obstacle at (3.")


def test_robot_that_is_shut_in_says_so() -> None:
    robot = place(2, 3)
    reason = explain(draw(ROOM), 0.2, box(robot.x - 0.8, robot.y - 0.8, robot.x + 0.8, robot.y + 0.8))
    assert reason.kind == "apart"
