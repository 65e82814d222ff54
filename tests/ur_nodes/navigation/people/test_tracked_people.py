"""The robot keeps room to people, and may leave where they come near."""

from dataclasses import replace

import numpy as np
from tests.ur_nodes.navigation.closed_loop import LIMITS, STAGE
from tests.ur_nodes.navigation.steering.test_local_plan import window

from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.people.tracked_people import MARGIN, TrackedPeople, leads_to_standing
from ur_nodes.navigation.plan_request import PlanRequest, answer_request
from ur_nodes.navigation.planning.global_plan import PlanSettings
from ur_nodes.navigation.planning.path_geometry import resample
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.local_plan import LocalCommand, follow_reference, sweep_is_free
from ur_nodes.navigation.steering.rollout import FollowSettings, RolloutState, make_reference

FOOTPRINT = footprint_of_outline(STAGE, 0.05, 0.01)
FRONT = float(FOOTPRINT.outline[:, 0].max())


def person(x: float, y: float, vx: float = 0.0, vy: float = 0.0) -> TrackedPeople:
    return TrackedPeople(np.array(((x, y),)), np.array(((vx, vy),)), np.array((0.2,)))


def command(people: TrackedPeople, speed: float = 0.5) -> LocalCommand:
    """The next command of a robot that drives along x from (0.5, 0)."""
    reference = make_reference(resample(np.array([(0.0, 0.0), (4.0, 0.0)]), 0.05), LIMITS)
    motion = RolloutState(Pose2(0.5, 0.0, 0.0), speed, 0.0)
    around = LocalObstacles(window(), people)
    return follow_reference(reference, 10, motion, around, FOOTPRINT, LIMITS, FollowSettings(), 0.1)


def test_one_who_walks_ahead_at_the_same_speed_hinders_nothing() -> None:
    assert not command(person(1.4, 0.0, 0.5, 0.0)).hindered
    assert command(person(1.4, 0.0)).speed < 0.5


def test_one_who_comes_towards_the_robot_slows_it_down_early() -> None:
    assert not command(person(1.9, 0.0)).hindered
    assert command(person(1.9, 0.0, -0.8, 0.0)).speed < 0.5


def test_one_who_walks_away_just_ahead_may_stop() -> None:
    assert command(person(0.5 + FRONT + 0.2 + 0.3, 0.0, 0.6, 0.0), speed=0.5).speed < 0.5


def test_one_who_leaves_may_stop_before_the_robot_can() -> None:
    around = LocalObstacles(window(), person(FRONT + 0.2 + 0.35, 0.0, 0.4, 0.0))
    assert not sweep_is_free(RolloutState(Pose2(0.0, 0.0, 0.0), 0.3, 0.0), 0.5, around, FOOTPRINT)
    assert sweep_is_free(RolloutState(Pose2(0.0, 0.0, 0.0), 0.1, 0.0), 0.5, around, FOOTPRINT)


def test_the_robot_does_not_come_nearer_bit_by_bit() -> None:
    here = Pose2(0.0, 0.0, 0.0)
    ahead = RolloutState(here, 0.05, 0.0)
    for room, free in ((0.285, True), (0.26, False), (0.2, False)):
        around = LocalObstacles(window(), person(FRONT + 0.2 + room, 0.0))
        assert sweep_is_free(ahead, 0.3, around, FOOTPRINT) == free
        assert sweep_is_free(RolloutState(here, -0.05, 0.0), 0.3, around, FOOTPRINT)


def test_one_who_crosses_after_the_robot_has_passed_hinders_nothing() -> None:
    crossing = person(1.2, 3.2, 0.0, -0.8)
    assert not command(crossing).hindered


def test_the_robot_waits_before_one_who_stands_in_the_way() -> None:
    step = command(person(0.5 + FRONT + 0.2 + MARGIN, 0.0), speed=0.0)
    assert step.blocked
    assert step.waits
    assert step.speed == 0.0


def test_the_robot_may_leave_one_who_is_near_and_not_go_to_them() -> None:
    around = LocalObstacles(window(), person(FRONT + 0.3, 0.0))
    here = Pose2(0.0, 0.0, 0.0)
    assert sweep_is_free(RolloutState(here, -0.1, 0.0), 0.5, around, FOOTPRINT)
    assert not sweep_is_free(RolloutState(here, 0.1, 0.0), 0.5, around, FOOTPRINT)


def test_a_path_leads_round_one_who_stands_where_there_is_room() -> None:
    costmap = window()
    request = PlanRequest(0, (0.0, 0.0), (3.0, 0.0), costmap, costmap, people=person(1.5, 0.0))
    path = answer_request(request, PlanSettings(), FOOTPRINT).path
    assert path is not None
    assert np.hypot(*(path - (1.5, 0.0)).T).min() > 0.2 + MARGIN + FOOTPRINT.inscribed - 0.05
    walking = PlanRequest(0, (0.0, 0.0), (3.0, 0.0), costmap, costmap, people=person(1.5, 0.0, 0.8, 0.0))
    straight = answer_request(walking, PlanSettings(), FOOTPRINT).path
    assert straight is not None
    assert abs(straight[:, 1]).max() < 0.1


def test_a_path_leads_to_one_who_stands_in_the_only_way() -> None:
    costmap = window((1.5, 1.6, 2.6), (1.5, -1.6, 2.6))
    request = PlanRequest(0, (-0.5, 0.0), (3.0, 0.0), costmap, costmap, people=person(1.5, 0.0))
    assert answer_request(request, PlanSettings(), FOOTPRINT).path is not None


def test_a_path_leads_to_one_who_stands_where_only_people_are_marked_as_obstacles() -> None:
    walls, marked = ((1.5, 1.75, 2.9), (1.5, -1.75, 2.9)), (1.5, 0.0, 0.7)
    blocked = PlanRequest(0, (-0.5, 0.0), (3.0, 0.0), window(*walls, marked), window(*walls))
    assert answer_request(blocked, PlanSettings(), FOOTPRINT).path is None
    people = replace(blocked, people=person(1.5, 0.0))
    assert answer_request(people, PlanSettings(), FOOTPRINT).path is not None
    elsewhere = replace(blocked, people=person(-1.0, 0.0))
    assert answer_request(elsewhere, PlanSettings(), FOOTPRINT).path is None


def way_round(waited: float, yaw: float = 0.0) -> float:
    """The farthest that a path from the middle of one of two corridors, with somebody in it, leads aside, m."""
    costmap = window((1.5, 0.7, 0.8), (1.5, -1.0, 1.2))
    request = PlanRequest(
        0, (0.2, 0.0), (3.0, 0.0), costmap, costmap, yaw=yaw, people=person(1.5, -0.05), waited=waited
    )
    path = answer_request(request, PlanSettings(), FOOTPRINT).path
    assert path is not None
    return float(path[:, 1].max())


def test_the_longer_the_robot_has_waited_the_longer_is_the_path_round_people() -> None:
    assert way_round(0.0) < 0.3
    assert way_round(6.0) > 1.1


def test_a_path_that_leads_to_one_who_stands_is_noticed_and_one_that_leads_past_is_not() -> None:
    path = resample(np.array([(0.0, 0.0), (3.0, 0.0)]), 0.05)
    assert leads_to_standing(path, person(2.0, 0.3), FOOTPRINT)
    assert not leads_to_standing(path, person(2.0, 1.0), FOOTPRINT)
    assert not leads_to_standing(path, person(2.0, 0.0, 0.8, 0.0), FOOTPRINT)
