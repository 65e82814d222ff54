import math

from tests.ur_nodes.exploration.drawn import ROOM, draw, place

from ur_nodes.exploration.search.floor import read_floor
from ur_nodes.exploration.search.frontiers import find_frontiers
from ur_nodes.exploration.search.viewpoints import find_viewpoint

CORNER = "??????#\n#####.#\n#.....#\n#.....#\n#######"


def test_viewpoint_is_the_nearest_place_in_sight_of_the_frontier() -> None:
    floor = read_floor(draw(ROOM), place(3, 4), 0.2)
    (frontier,) = find_frontiers(floor, 0.3)
    found = find_viewpoint(floor, frontier, 1.0)
    assert found is not None
    assert 1.0 < found.distance < 2.0
    assert floor.reachable[found.cell]


def test_wall_hides_a_frontier() -> None:
    floor = read_floor(draw(CORNER), place(1, 3, CORNER), 0.15)
    (frontier,) = find_frontiers(floor, 0.3)
    found = find_viewpoint(floor, frontier, 2.5)
    assert found is not None
    assert abs(found.pose.x - place(5, 1, CORNER).x) < 0.5  # below the opening, not where it is nearest


def test_place_has_the_room_that_is_asked_for() -> None:
    floor = read_floor(draw(ROOM), place(3, 4), 0.2)
    (frontier,) = find_frontiers(floor, 0.3)
    found = find_viewpoint(floor, frontier, 2.5, clearance=0.7)
    assert found is not None
    assert floor.clearance[found.cell] >= 0.7
    assert find_viewpoint(floor, frontier, 0.5, clearance=2.0) is None


def test_robot_arrives_looking_ahead_and_faces_the_frontier_when_asked() -> None:
    floor = read_floor(draw(ROOM), place(3, 4), 0.2)
    (frontier,) = find_frontiers(floor, 0.3)
    ahead, facing = (find_viewpoint(floor, frontier, 1.0, facing=each) for each in (False, True))
    assert ahead is not None
    assert facing is not None
    assert abs(ahead.pose.yaw) < math.pi / 2  # it drives to the right
    towards = math.atan2(frontier.point[1] - facing.pose.y, frontier.point[0] - facing.pose.x)
    assert abs(facing.pose.yaw - towards) < 1.2


def test_frontier_that_nothing_leads_to_has_no_viewpoint() -> None:
    floor = read_floor(draw(ROOM), place(3, 4), 0.5)
    (frontier,) = find_frontiers(floor, 0.3)
    assert find_viewpoint(floor, frontier, 0.5) is None
