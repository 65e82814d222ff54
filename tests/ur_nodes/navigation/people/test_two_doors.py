"""A wall with two doors, in one of which somebody stands, driven with real plans."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.ur_nodes.navigation.closed_loop import LIMITS, STAGE

from ur_nodes.costmap.costmap import LETHAL, Costmap
from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.navigator import Navigator
from ur_nodes.navigation.navigator_step import Ending, NavigatorInputs, NavigatorSettings
from ur_nodes.navigation.people.tracked_people import TrackedPeople
from ur_nodes.navigation.plan_request import PlanRequest, answer_request
from ur_nodes.navigation.planning.global_plan import PlanSettings
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.rollout import RolloutState
from ur_nodes.navigation.steering.speed_profile import AT_REST

FOOTPRINT = footprint_of_outline(STAGE, 0.05, 0.01)
GOAL = Pose2(3.0, 0.0, 0.0)
PERSON = TrackedPeople(np.array([(1.35, 0.0)]), np.zeros((1, 2)), np.array([0.2]))


def make_wall(second_door: float) -> Costmap:
    """A wall with a door ahead, and one that far to the left, m."""
    costmap = Costmap(np.zeros((160, 120), np.uint8), 0.05, Pose2(-2.0, -3.0, 0.0))
    places = costmap.points_of_cells(np.moveaxis(np.indices((160, 120)), 0, -1))
    x, y = places[..., 0], places[..., 1]
    costmap.costs[(x > 1.2) & (x < 1.5) & (abs(y) > 0.5) & (abs(y - second_door) > 0.5)] = LETHAL
    return costmap


@pytest.mark.parametrize("second_door", [2.0, 2.5])
def test_robot_takes_the_other_door_where_somebody_does_not_leave_one(second_door: float) -> None:
    costmap, navigator = make_wall(second_door), Navigator(NavigatorSettings(), LIMITS, FOOTPRINT)
    navigator.start(GOAL, 0.0)
    motion, answer = RolloutState(Pose2(-1.0, 0.0, 0.0), 0.0, 0.0), None
    for step in range(600):
        local = LocalObstacles(costmap, PERSON)
        out = navigator.step(NavigatorInputs(0.1 * step, motion, Pose2(0.0, 0.0, 0.0), local, answer))
        if out.ending:
            break
        x, y, yaw = motion.pose
        asked = PlanRequest(0, (x, y), GOAL[:2], costmap, costmap, yaw=yaw, heading=0.0, people=PERSON)
        asked = replace(asked, careful=out.careful, waited=out.waited)
        answer = answer_request(asked, PlanSettings(), FOOTPRINT) if out.plan else None
        speed, turn, _ = out.command or AT_REST
        there = Pose2(x + 0.1 * speed * math.cos(yaw), y + 0.1 * speed * math.sin(yaw), yaw + 0.1 * turn)
        motion = RolloutState(there, speed, turn)
    assert out.ending is Ending.REACHED, out.text
