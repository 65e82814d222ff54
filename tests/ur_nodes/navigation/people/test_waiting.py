"""The robot waits for people at some distance, makes room for those who do not leave, and gives up in the end."""

import math
from copy import deepcopy
from dataclasses import dataclass, field

import numpy as np
import pytest
from tests.ur_nodes.navigation.closed_loop import LIMITS, STAGE
from tests.ur_nodes.navigation.people.test_tracked_people import FRONT, person
from tests.ur_nodes.navigation.steering.test_local_plan import window

from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.navigator import Navigator
from ur_nodes.navigation.navigator_step import NavigatorInputs, NavigatorPhase, NavigatorSettings, PlanAnswer
from ur_nodes.navigation.people.tracked_people import MARGIN, NO_PEOPLE, TrackedPeople
from ur_nodes.navigation.planning.path_geometry import resample
from ur_nodes.navigation.pursuit import GoalPursuit
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.rollout import RolloutState
from ur_nodes.navigation.steering.speed_profile import AT_REST

HOME, GOAL = Pose2(0.0, 0.0, 0.0), Pose2(3.0, 0.0, 0.0)
PATH = resample(np.array([(0.0, 0.0), (3.0, 0.0)]), 0.05)


@dataclass
class Corridor:
    """A robot on its way along x in a corridor of 1.2 m."""

    goal: Pose2 = GOAL
    now: float = 0.0
    motion: RolloutState = field(default_factory=lambda: RolloutState(HOME, 0.0, 0.0))
    logged: list[str] = field(default_factory=list)
    speeds: list[float] = field(default_factory=list)
    plans: int = 0

    def __post_init__(self) -> None:
        self.navigator = Navigator(NavigatorSettings(), LIMITS, footprint_of_outline(STAGE, 0.05, 0.01))
        self.navigator.start(self.goal, self.now)

    def drive(self, seconds: float, people: TrackedPeople = NO_PEOPLE) -> None:
        """Go on for a time; each plan is the straight path from the start."""
        answer: PlanAnswer | None = None
        around = LocalObstacles(window((1.5, 2.1, 3.0), (1.5, -2.1, 3.0)), people)
        for _ in range(round(10 * seconds)):
            self.now += 0.1
            out = self.navigator.step(NavigatorInputs(self.now, self.motion, HOME, around, answer))
            x, y, yaw = self.motion.pose
            rest = PATH[PATH[:, 0] > min(x, self.goal.x - 0.1)]
            self.plans += out.plan
            answer = PlanAnswer(rest[rest[:, 0] <= self.goal.x + 1e-6]) if out.plan else None
            v, w, _ = out.command or AT_REST
            pose = Pose2(x + 0.1 * v * math.cos(yaw), y + 0.1 * v * math.sin(yaw), yaw + 0.1 * w)
            self.motion = RolloutState(pose, v, w)
            self.logged += [text for text in (out.log, out.text) if text]
            self.speeds.append(v)


def test_the_robot_waits_at_a_distance_from_one_who_stands_in_the_way() -> None:
    corridor = Corridor()
    corridor.drive(7.0, person(2.0, 0.0))
    assert MARGIN - 0.02 < 2.0 - 0.2 - FRONT - corridor.motion.pose.x < MARGIN + 0.1
    assert corridor.logged == ["waiting for people"]


def test_a_path_round_one_who_stands_on_it_is_asked_for_before_the_robot_slows_down() -> None:
    corridor = Corridor()
    corridor.drive(1.5)
    assert corridor.plans == 1
    corridor.drive(0.3, person(2.5, 0.0))
    assert corridor.plans == 2
    assert corridor.speeds[-1] >= corridor.speeds[-3] > 0.4


def test_the_robot_goes_on_when_they_have_left() -> None:
    corridor = Corridor()
    corridor.drive(6.0, person(2.0, 0.0))
    corridor.drive(0.5)
    assert corridor.speeds[-1] > 0.3


def test_a_few_centimetres_do_not_end_the_waiting_for_people() -> None:
    run = GoalPursuit(GOAL, NavigatorPhase.DRIVING, 0.0)
    run.wait(1.0, HOME)
    run.drive_on(Pose2(0.2, 0.0, 0.0))
    assert run.wait(3.0, Pose2(0.2, 0.0, 0.0)) == 2.0
    run.drive_on(Pose2(0.4, 0.0, 0.0))
    assert run.waited(4.0) == 0.0


def test_waiting_of_long_ago_does_not_count() -> None:
    run = GoalPursuit(GOAL, NavigatorPhase.DRIVING, 0.0)
    assert [run.wait(now, HOME) for now in (10.0, 12.0, 20.0)] == [0.0, 2.0, 10.0]
    assert run.waited(30.0) == 20.0
    assert run.waited(40.0) == 0.0
    assert [run.wait(now, HOME) for now in (40.0, 41.0)] == [0.0, 1.0]


@pytest.fixture(scope="module")
def blocked() -> list[Corridor]:
    """A robot before one who does not leave, after 4 s, 24 s and 34 s."""
    corridor, states = Corridor(), []
    for seconds in (4.0, 20.0, 10.0):
        corridor.drive(seconds, person(2.0, 0.0))
        states.append(deepcopy(corridor))
    return states


def test_the_robot_makes_room_once_for_one_who_does_not_leave(blocked: list[Corridor]) -> None:
    stopped, room_made, later = blocked
    assert min(room_made.speeds) < -0.1
    assert "making room for people" in room_made.logged
    assert min(later.speeds[len(room_made.speeds) :]) >= 0.0
    assert abs(later.motion.pose.x - stopped.motion.pose.x) < 0.1


def test_the_robot_goes_on_as_soon_as_those_it_made_room_for_have_left_the_path() -> None:
    corridor = Corridor()
    while "making room for people" not in corridor.logged:
        corridor.drive(1.0, person(2.0, 0.0))
    corridor.drive(2.5, person(2.0, 0.0))
    assert corridor.speeds[-1] < 0.0
    corridor.drive(1.5, person(corridor.motion.pose.x, 1.2))
    assert corridor.speeds[-1] > 0.1


def test_the_robot_gives_up_waiting_in_the_end(blocked: list[Corridor]) -> None:
    corridor = deepcopy(blocked[-1])
    corridor.drive(26.0, person(2.0, 0.0))
    assert any("people are in the way" in line for line in corridor.logged)


def test_a_robot_that_cannot_turn_at_its_goal_beside_a_person_makes_room() -> None:
    corridor = Corridor(Pose2(1.5, 0.0, math.pi))
    corridor.drive(5.0)
    assert corridor.motion.pose.x > 1.3
    x, y, _ = corridor.motion.pose
    corridor.drive(9.0, person(x + 0.2, y - 0.62))
    assert corridor.logged[:2] == ["waiting for people", "making room for people"]


def test_a_robot_that_people_keep_from_the_last_centimetres_has_arrived() -> None:
    corridor = Corridor(Pose2(1.5, 0.0, 0.0))
    corridor.drive(12.0, person(1.5 + FRONT + 0.2 + MARGIN - 0.04, 0.0))
    assert corridor.logged[-1] == "goal reached"
