from dataclasses import replace

import pytest
from tests.ur_nodes.exploration.drawn import ROOM, draw, place

from ur_nodes.exploration.search.floor import Floor, read_floor
from ur_nodes.exploration.search.frontiers import Frontier, find_frontiers, unknown_behind
from ur_nodes.geometry.grid import Grid


def frontiers_of(grid: Grid, smallest: float = 0.3) -> tuple[Floor, tuple[Frontier, ...]]:
    floor = read_floor(grid, place(3, 4), 0.2)
    return floor, find_frontiers(floor, smallest)


def test_frontier_is_where_known_floor_ends() -> None:
    _, found = frontiers_of(draw(ROOM))
    assert len(found) == 1
    # The floor beyond the door: its end and both its sides.
    assert found[0].point == pytest.approx((4.9, 2.0), abs=0.5)
    assert found[0].gain > 2.0


def test_room_that_is_known_has_no_frontier() -> None:
    _, found = frontiers_of(draw("####\n#..#\n#..#\n####"))
    assert found == ()


def test_gaps_between_beams_are_no_frontiers() -> None:
    grid = draw("########\n#......#\n#......#\n#......#\n########")
    values = grid.values.copy()
    values[20, 10:40:4] = -1
    values[18, 10:40] = -1
    _, found = frontiers_of(replace(grid, values=values))
    assert found == ()


def test_floor_at_the_edge_of_the_grid_is_a_frontier() -> None:
    _, found = frontiers_of(draw("####\n....\n....\n####"))
    assert sorted(round(each.point[0], 1) for each in found) == [0.0, 1.6]


def test_short_frontiers_are_left_out() -> None:
    assert frontiers_of(draw(ROOM), smallest=5.0)[1] == ()


def test_long_frontier_is_cut_into_pieces() -> None:
    text = "\n".join(["?" * 14, "#" + "." * 12 + "#", "#" + "." * 12 + "#", "#" * 14])
    _, found = frontiers_of(draw(text))
    assert len(found) == 2
    assert sum(each.size for each in found) == pytest.approx(12 * 0.4)


def test_gain_is_what_lies_behind_and_not_behind_walls() -> None:
    open_, closed = "?????\n?????\n.....\n#####\n", "#####\n??..#\n....#\n#####\n"
    gains = [sum(each.gain for each in frontiers_of(draw(text))[1]) for text in (open_, closed)]
    assert gains[0] > 1.0
    assert gains[1] == pytest.approx(2 * 0.4 * 0.4, rel=0.1)


def test_unknown_space_is_counted_once() -> None:
    floor, found = frontiers_of(draw(ROOM))
    assert unknown_behind(floor, (*found, *found)) == unknown_behind(floor, found) > 1.0
    assert unknown_behind(floor, ()) == 0.0
