"""Patrols that live on the robot: real programs, real nodes, one robot for all tests of this file.

The default suite has the same on a bus: tests/ur_nodes/missions/robot/test_patrol_node.py.
"""

import os
import signal

import pytest
from tests.e2e.conftest import LaunchedRobot
from tests.e2e.terminal import ProgramTerminal
from tests.e2e.test_attended_goals import environment, navigate
from tests.e2e.test_first_drive import find_node, put_at_start
from tests.e2e.test_safe_motion import NAVIGATE, stand

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]

NEAR = [{"name": "sofa", "x": 0.5, "y": 0.0}, {"name": "hall", "x": 0.9, "y": 0.0}]
FAR = [{"name": "attic", "x": 7.23, "y": 10.63}, *NEAR]


@pytest.fixture(autouse=True)
def _quiet(robot: LaunchedRobot) -> None:
    robot.ask("ask_patrol", action="end", seconds=150)
    put_at_start(robot)


def test_patrol_goes_on_without_the_program_that_started_it_until_another_ends_it(robot: LaunchedRobot) -> None:
    lines = "g 0.5 0\nw sofa\ng 0.9 0\nw hall\npatrol loop wait=0 sofa hall\n"
    with navigate(robot, "laptop", lines, keep_open=False) as process:
        out, errors = process.communicate(timeout=120)
        assert out.splitlines()[-1] == "patrol loop wait=0 sofa hall: started", out + errors
    robot.ask("patrol", state="driving", rounds=2, seconds=150)
    with ProgramTerminal([NAVIGATE, "__name:=second"], environment(robot, "laptop2")) as terminal:
        terminal.wait_for("patrol: drives to")
        terminal.type("patrol pause\r")
        terminal.wait_for("patrol paused before")
        assert robot.ask("patrol", state="paused", seconds=150)["reason"] == "by laptop2"
        stand(robot)
        terminal.type("patrol resume\r")
        robot.ask("patrol", state="driving", seconds=150)
        terminal.type("patrol end\r")
        robot.ask("patrol", state="ended", seconds=150)
        robot.ask("free", seconds=150)
        terminal.type("q\r")
        terminal.process.wait(60)
    stand(robot)


def test_killed_node_leaves_nothing_driving_and_forgets_the_patrol(robot: LaunchedRobot) -> None:
    assert robot.ask("ask_patrol", action="start", places=FAR, loop=True, seconds=150) == {"problem": ""}
    robot.ask("moving", seconds=150)
    victim = find_node(robot, "patrol")
    os.kill(victim, signal.SIGKILL)
    find_node(robot, "patrol", other_than=victim)
    robot.ask("patrol", state="idle", seconds=150)
    stand(robot)
    robot.ask("goals", state="PREEMPTED", text="", seconds=150)
    robot.ask("free", seconds=150)
