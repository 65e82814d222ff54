from dataclasses import replace

from tests.ur_nodes.exploration.drawn import ROOM, draw, place

from ur_nodes.exploration.explorer import AttemptMemory, Reason
from ur_nodes.exploration.search.floor import read_floor
from ur_nodes.exploration.search.frontiers import find_frontiers

FAILED = Reason("failed", (4.9, 2.0), "at (4.90, 2.00): no path")


def test_frontier_that_failed_is_given_up_until_the_map_changes_there() -> None:
    grid = draw(ROOM)
    floor = read_floor(grid, place(3, 4), 0.2)
    (frontier,) = find_frontiers(floor, 0.3)
    memory = AttemptMemory().fail(frontier.point, FAILED, floor)
    assert memory.refresh(floor).refused(frontier) == FAILED
    values = grid.values.copy()
    values[:, :24] = 0  # elsewhere
    assert memory.refresh(read_floor(replace(grid, values=values), place(3, 4), 0.2)).refused(frontier) == FAILED
    row, column = floor.cell(*frontier.point)
    values[row : row + 20, column : column + 20] = 0
    assert memory.refresh(read_floor(replace(grid, values=values), place(3, 4), 0.2)).refused(frontier) is None


def test_retry_allows_so_many_failures() -> None:
    memory = AttemptMemory().fail((4.9, 2.0), FAILED, None)
    again = memory.retry(2)
    assert again.find((4.9, 2.0)).reason is None
    twice = again.fail((4.9, 2.1), FAILED, None)
    assert twice.find((4.9, 2.0)).failures == 2
    assert twice.retry(2) == twice


def test_looks_are_counted_for_a_frontier_and_not_for_its_neighbours() -> None:
    memory = AttemptMemory().look((1.0, 1.0), None).look((1.1, 1.0), None)
    assert memory.find((1.0, 1.1)).looks == 2
    assert memory.find((3.0, 1.0)).looks == 0


def test_looks_begin_anew_when_the_frontier_moves_on() -> None:
    grid = draw(ROOM)
    floor = read_floor(grid, place(3, 4), 0.2)
    (frontier,) = find_frontiers(floor, 0.3)
    memory = AttemptMemory().look(frontier.point, floor)
    assert memory.refresh(floor).find(frontier.point).looks == 1
    values = grid.values.copy()
    row, column = floor.cell(*frontier.point)
    values[row : row + 20, column : column + 20] = 0
    assert memory.refresh(read_floor(replace(grid, values=values), place(3, 4), 0.2)).find(frontier.point).looks == 0
