"""Attended goals of `move_base` on a bus: a mux that issues challenges and says who drives, a robot of mathematics."""

import itertools
import json
import math

import pytest
from tests.fakes.mux import FakeMux
from tests.ur_nodes.navigation.robot_stage import RobotStage

from ur_nodes.motion.lease.text import LEASE_TIMEOUT
from ur_nodes.navigation.goals.goal_claim import write_any_heading, write_goal_id
from ur_nodes.ports.values import Twist

ENDS = ((-0.8, 0.5), (3.0, -1.0))  # one in each room
NUMBERS = itertools.count()


class Attended(RobotStage):
    """A robot with a mux, and goals that are sent as our clients send them."""

    def __init__(self, *, mute: bool = False) -> None:
        super().__init__(mux=True, mute=mute)
        assert self.mux
        self.driver: FakeMux = self.mux
        self.holds: list[dict[str, str]] = []
        self.client.subscribe("move_base/hold", str, lambda text: self.holds.append(json.loads(text)))

    def claim(
        self, x: float, y: float, client: str = "aa", age: float = 0.0, yaw: float = 0.0, start: str = "test"
    ) -> str:
        """Send a goal whose id says who sends it, and answers a challenge `age` s old."""
        id = write_goal_id(f"{next(NUMBERS)}-{start}", client, self.driver.newest - round(age * 1e9))
        return self.send(x, y, yaw, id=id)

    def takes_goals(self) -> bool:
        """Whether `move_base` offers its action."""
        return self._goals.subscribers() > 0

    def drive_away(self) -> str:
        """A goal in the other room that the robot drives to, and that laptop attends."""
        self.driver.say("held")
        goal = self.claim(*max(ENDS, key=lambda end: self.away(*end)))
        assert self.starts_moving()
        return goal


@pytest.fixture
def robot() -> Attended:
    return Attended()


def test_goals_are_taken_from_the_first_challenge_on() -> None:
    robot = Attended(mute=True)
    assert not robot.takes_goals()
    robot.driver.mute = False
    robot.bus.run(0.05)
    assert robot.takes_goals()
    goal = robot.claim(*ENDS[1])
    assert robot.has_status(goal, "active", "", 0.5)


def test_goals_are_taken_where_no_mux_issues_challenges() -> None:
    robot = Attended(mute=True)
    robot.bus.run(4.5)
    assert robot.takes_goals()
    assert robot.has_status(robot.send(*ENDS[1]), "active", "", 0.5)


def test_goal_is_held_while_its_client_is_lost_and_resumed_when_it_is_back(robot: Attended) -> None:
    goal = robot.drive_away()
    robot.driver.say("lost")
    assert robot.has_status(goal, "active", "held: no word from laptop for 2 s")
    assert robot.stops_moving()
    assert robot.holds[-1] == {"goal": goal, "state": "held", "text": robot.states[goal].text}
    place = robot.pose
    assert robot.has_status(goal, "active", "held: no word from laptop for 5 s")
    assert robot.away(place.x, place.y) < 0.02
    robot.driver.say("held")
    assert robot.end(goal) == ("succeeded", "goal reached")
    assert min(robot.away(*end) for end in ENDS) < 0.15
    assert robot.holds[-1] == {"goal": "", "state": "", "text": ""}


def test_goal_of_a_lost_client_is_held_in_time_however_late_it_arrived(robot: Attended) -> None:
    robot.driver.say("lost")
    robot.bus.run(1.0)
    goal = robot.claim(*ENDS[1], age=0.9)
    assert robot.has_status(goal, "active", "", 0.5)
    assert robot.has_status(goal, "active", "held: ", LEASE_TIMEOUT - 0.5)


def test_goal_is_cancelled_when_another_client_takes_over(robot: Attended) -> None:
    goal = robot.drive_away()
    robot.driver.say("held", client="bb", name="laptop2")
    assert robot.end(goal, 1.0) == ("cancelled", "laptop2 took over")
    assert robot.stops_moving()


def test_robot_does_not_turn_at_a_goal_that_asks_for_no_heading(robot: Attended) -> None:
    robot.driver.say("held")
    goal = robot.claim(3.0, -1.0, yaw=math.pi, start=write_any_heading("test"))
    assert robot.end(goal)[0] == "succeeded"
    assert robot.away(3.0, -1.0) < 0.15
    assert math.cos(robot.pose.yaw) > 0.0


def test_goal_that_arrives_late_is_refused_and_changes_nothing(robot: Attended) -> None:
    goal = robot.drive_away()
    late = robot.claim(0.0, 0.0, age=1.5)
    state, text = robot.end(late, 0.5)
    assert state == "aborted"
    assert text.startswith("the goal arrived late (1.")
    assert robot.has_status(goal, "active", "", 0.5)
    assert robot.command[0] > 0.2


def test_goal_of_another_client_than_the_driver_is_refused(robot: Attended) -> None:
    robot.drive_away()
    state, text = robot.end(robot.claim(0.0, 0.0, client="bb"), 0.5)
    assert state == "aborted"
    assert text.startswith("laptop drives since ")
    assert robot.command[0] > 0.2


def test_held_goal_can_be_cancelled(robot: Attended) -> None:
    goal = robot.drive_away()
    robot.driver.say("lost")
    assert robot.has_status(goal, "active", "held: ")
    robot.cancel(goal)
    assert robot.end(goal, 0.1) == ("cancelled", "cancelled")
    assert robot.stops_moving()
    robot.driver.say("held")
    assert robot.rests()


def test_goal_without_a_client_follows_who_drives_and_an_unattended_client_need_not_be_there(robot: Attended) -> None:
    robot.driver.say("held")
    goal = robot.send(*ENDS[1])
    assert robot.starts_moving()
    robot.driver.say("lost")
    assert robot.stops_moving()
    robot.driver.say("lost", attended=False)
    assert robot.end(goal)[0] == "succeeded"


def test_silence_of_the_mux_holds_the_goal(robot: Attended) -> None:
    goal = robot.drive_away()
    robot.driver.mute = True
    assert robot.has_status(goal, "active", "held: no word from the mux for ")
    assert robot.stops_moving()
    robot.driver.mute = False
    assert robot.starts_moving()


def test_commands_are_never_plain_once_a_mux_takes_stamped_ones(robot: Attended) -> None:
    plain: list[Twist] = []
    robot.node.subscribe("cmd_vel", Twist, plain.append)
    goal = robot.drive_away()
    assert robot.end(goal)[0] == "succeeded"
    assert plain == []
    assert robot.commands > 50
