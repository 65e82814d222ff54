"""Attended goals: the real node, a mux that issues challenges and says who drives, a robot made of mathematics."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.ros_session import Client
from tests.ur_nodes.navigation.test_move_base_node import start_robot

pytestmark = pytest.mark.ros

LAPTOP = {"client": "aa", "name": "laptop", "since": 50.0, "attended": True, "asking": []}
ENDS = ((-0.8, 0.5), (3.0, -1.0))  # one in each room
NUMBERS = iter(range(1000))


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    with start_robot(tmp_path_factory.mktemp("attended"), "scan", "mux") as robot:
        yield robot


@pytest.fixture
def asking_robot(tmp_path: Path) -> Iterator[Client]:
    with start_robot(tmp_path, "scan", "mux", on_return="ask") as robot:
        yield robot


def say(robot: Client, state: str, **changes: Any) -> None:
    robot.ask("lease", state=state, **(LAPTOP | changes))


def send(robot: Client, x: float, y: float, client: str = "aa", age: float = 0.0) -> str:
    """The id of a goal that was sent as our clients send them."""
    return str(robot.ask("claim", client=client, age=age, number=next(NUMBERS), x=x, y=y)["id"])


def drive_away(robot: Client) -> str:
    """A goal in the other room that the robot drives to, and that laptop attends."""
    say(robot, "held")
    here = robot.ask("stopped", seconds=60.0)
    x, y = max(ENDS, key=lambda end: math.hypot(end[0] - here["x"], end[1] - here["y"]))
    goal = send(robot, x, y)
    robot.ask("moving", seconds=60.0)
    return goal


def stop(robot: Client, goal: str) -> None:
    robot.ask("cancel_id", id=goal)
    robot.ask("status", id=goal, text="cancelled", state="PREEMPTED", seconds=60.0)
    robot.ask("stopped", seconds=60.0)


def test_goal_is_held_while_its_client_is_lost_and_resumed_when_it_is_back(robot: Client) -> None:
    goal = drive_away(robot)
    say(robot, "lost")
    robot.ask("status", id=goal, text="held: no word from laptop for 3 s", state="ACTIVE", seconds=60.0)
    stop = robot.ask("stopped", seconds=60.0)
    held = robot.ask("status", id=goal, text="held: no word from laptop for 5 s", state="ACTIVE", seconds=60.0)
    assert math.hypot(held["x"] - stop["x"], held["y"] - stop["y"]) < 0.02
    say(robot, "held")
    end = robot.ask("status", id=goal, text="goal reached", state="SUCCEEDED", seconds=60.0)
    assert min(math.hypot(end["x"] - x, end["y"] - y) for x, y in ENDS) < 0.15


def test_goal_is_cancelled_when_another_client_takes_over(robot: Client) -> None:
    goal = drive_away(robot)
    say(robot, "held", client="bb", name="laptop2")
    robot.ask("status", id=goal, text="laptop2 took over", state="PREEMPTED", seconds=60.0)
    robot.ask("stopped", seconds=60.0)


def test_robot_does_not_turn_at_a_goal_that_asks_for_no_heading(robot: Client) -> None:
    say(robot, "held")
    here = robot.ask("stopped", seconds=60.0)
    x, y = max(ENDS, key=lambda end: math.hypot(end[0] - here["x"], end[1] - here["y"]))
    arrives = 0.0 if x > here["x"] else math.pi  # about: the door lies between
    sent = {"client": "aa", "number": next(NUMBERS), "x": x, "y": y, "yaw": arrives + math.pi}
    goal = robot.ask("claim", start="test!any-heading", **sent)["id"]
    end = robot.ask("status", id=goal, text="goal reached", state="SUCCEEDED", seconds=60.0)
    assert math.hypot(end["x"] - x, end["y"] - y) < 0.15
    assert math.cos(end["yaw"] - arrives) > 0.0


def test_goal_that_arrives_late_is_refused_and_changes_nothing(robot: Client) -> None:
    goal = drive_away(robot)
    late = send(robot, age=1.5, x=0.0, y=0.0)
    robot.ask("status", id=late, text="the goal arrived late (1.", state="ABORTED", seconds=60.0)
    robot.ask("status", id=goal, text="", state="ACTIVE", seconds=60.0)
    robot.ask("moving", seconds=60.0)
    stop(robot, goal)


def test_goal_of_another_client_than_the_driver_is_refused(robot: Client) -> None:
    goal = drive_away(robot)
    other = send(robot, client="bb", x=0.0, y=0.0)
    robot.ask("status", id=other, text="laptop drives since ", state="ABORTED", seconds=60.0)
    robot.ask("moving", seconds=60.0)
    stop(robot, goal)


def test_held_goal_can_be_cancelled(robot: Client) -> None:
    goal = drive_away(robot)
    say(robot, "lost")
    robot.ask("status", id=goal, text="held: ", state="ACTIVE", seconds=60.0)
    stop(robot, goal)
    say(robot, "held")
    assert robot.ask("commands")["commands"] == 0


def test_goal_without_a_client_follows_who_drives_and_an_unattended_client_need_not_be_there(robot: Client) -> None:
    stop(robot, drive_away(robot))
    robot.ask("goal", name="rviz", x=0.0, y=0.0)
    robot.ask("moving", seconds=60.0)
    say(robot, "lost")
    robot.ask("stopped", seconds=60.0)
    say(robot, "lost", attended=False)
    assert robot.ask("end", name="rviz", seconds=60.0)["state"] == "SUCCEEDED"


def test_silence_of_the_mux_holds_the_goal(robot: Client) -> None:
    goal = drive_away(robot)
    robot.ask("mute", mute=True)
    try:
        robot.ask("stopped", seconds=60.0)
        robot.ask("status", id=goal, text="held: no word from the mux for ", state="ACTIVE", seconds=60.0)
    finally:
        robot.ask("mute", mute=False)
    robot.ask("moving", seconds=60.0)
    stop(robot, goal)


def test_robot_asks_before_it_goes_on_where_that_is_configured(asking_robot: Client) -> None:
    robot = asking_robot
    goal = drive_away(robot)
    say(robot, "lost")
    robot.ask("status", id=goal, text="held: no word", state="ACTIVE", seconds=60.0)
    say(robot, "held")
    asked = robot.ask("status", id=goal, text="held: laptop is back; continue or cancel", state="ACTIVE", seconds=60.0)
    robot.ask("continue", id=goal, late=True)
    robot.ask("continue", id="another goal")
    end = robot.ask("commands")
    assert end["commands"] == 0
    robot.ask("continue", id=goal)
    end = robot.ask("status", id=goal, text="goal reached", state="SUCCEEDED", seconds=60.0)
    assert math.hypot(end["x"] - asked["x"], end["y"] - asked["y"]) > 0.2
