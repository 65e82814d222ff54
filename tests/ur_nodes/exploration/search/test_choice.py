import numpy as np
from tests.ur_nodes.exploration.drawn import draw, place

from ur_nodes.exploration.search.choice import Weights, choose_viewpoint
from ur_nodes.exploration.search.floor import Floor, read_floor
from ur_nodes.exploration.search.frontiers import Frontier
from ur_nodes.exploration.search.viewpoints import Viewpoint
from ur_nodes.geometry.pose import Pose2

HALL = "####################\n#..................#\n#..................#\n####################"


def viewpoint(floor: Floor, column: float, gain: float = 1.0) -> Viewpoint:
    pose = place(column, 1.5, HALL)
    cell = floor.cell(pose.x, pose.y)
    frontier = Frontier(np.array([cell]), np.array(cell), (pose.x, pose.y), 0.4, gain)
    return Viewpoint(Pose2(*pose), cell, float(floor.distance[cell]), frontier)


def test_side_with_less_to_do_comes_first_even_if_it_is_not_the_nearest() -> None:
    floor = read_floor(draw(HALL), place(6, 1.5, HALL), 0.2)
    left, near, middle, far = (viewpoint(floor, column) for column in (2.5, 9, 12, 17))
    assert near.distance < left.distance
    assert choose_viewpoint(floor, (near, left, middle, far), Weights()) is left


def test_much_nearer_place_comes_first_though_the_whole_way_is_a_little_longer() -> None:
    floor = read_floor(draw(HALL), place(8, 1.5, HALL), 0.2)
    left, near, far = (viewpoint(floor, column) for column in (3, 9, 14))
    assert choose_viewpoint(floor, (left, near, far), Weights(first=1.0)) is left
    assert choose_viewpoint(floor, (left, near, far), Weights()) is near


def test_place_that_is_pursued_is_kept_when_another_is_as_good() -> None:
    floor = read_floor(draw(HALL), place(9.5, 1.5, HALL), 0.2)
    left, right = viewpoint(floor, 2), viewpoint(floor, 17)
    for each in (left, right):
        assert choose_viewpoint(floor, (left, right), Weights(), each.frontier.point) is each


def test_gain_decides_between_equal_ways() -> None:
    floor = read_floor(draw(HALL), place(9.5, 1.5, HALL), 0.2)
    left, right = viewpoint(floor, 2), viewpoint(floor, 17, gain=9.0)
    assert choose_viewpoint(floor, (left, right), Weights()) is right


def test_nothing_to_choose_from_is_none() -> None:
    floor = read_floor(draw(HALL), place(9.5, 1.5, HALL), 0.2)
    assert choose_viewpoint(floor, (), Weights()) is None
    only = viewpoint(floor, 2)
    assert choose_viewpoint(floor, (only,), Weights()) is only
