import numpy as np
from tests.ur_nodes.exploration.drawn import ROOM, box, draw, place

from ur_nodes.exploration.search.floor import nearest_cell, read_floor


def test_robot_gets_through_a_door_only_where_it_fits() -> None:
    beyond = place(10, 4.5)
    for radius, fits in ((0.3, True), (0.5, False)):
        floor = read_floor(draw(ROOM), place(3, 4), radius)
        assert bool(floor.reachable[floor.cell(beyond.x, beyond.y)]) is fits


def test_obstacle_in_the_door_closes_it() -> None:
    door = place(8, 4.5)
    floor = read_floor(draw(ROOM), place(3, 4), 0.2, box(door.x - 0.1, door.y - 0.4, door.x + 0.1, door.y + 0.4))
    beyond = place(11, 4.5)
    assert not floor.reachable[floor.cell(beyond.x, beyond.y)]


def test_way_goes_round_walls() -> None:
    floor = read_floor(draw("#######\n#..#..#\n#..#..#\n#.....#\n#######"), place(1, 1, "\n" * 4), 0.15)
    goal = place(5, 1, "\n" * 4)
    assert floor.distance[floor.cell(goal.x, goal.y)] > 1.3 * 4 * 0.4


def test_robot_inside_an_obstacle_reaches_nothing() -> None:
    robot = place(3, 4)
    floor = read_floor(draw(ROOM), robot, 0.2, box(robot.x - 0.8, robot.y - 0.8, robot.x + 0.8, robot.y + 0.8))
    assert not floor.reachable.any()


def test_nearest_cell_is_within_reach_or_none() -> None:
    grid = draw(ROOM)
    mask = np.zeros(grid.shape, bool)
    mask[20, 20] = True
    assert nearest_cell(grid, mask, (1.2, 1.0), 0.5) == (20, 20)
    assert nearest_cell(grid, mask, (3.0, 1.0), 0.5) is None
