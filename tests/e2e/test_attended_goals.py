"""Goals whose program is killed, taken over, late or out of reach: real programs, real nodes.

The default suite has the same on a bus: tests/ur_nodes/navigation/test_attended_goals.py.
"""

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from tests.e2e.conftest import LaunchedRobot
from tests.e2e.terminal import ProgramTerminal
from tests.e2e.test_first_drive import find_node, put_at_start
from tests.e2e.test_safe_motion import NAVIGATE, stand

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]

FAR = "g 7.23 10.63\n"


def environment(robot: LaunchedRobot, name: str, **more: str) -> dict[str, str]:
    return {**robot.env, "UR_CLIENT": f"client-of-{name}", "UR_CLIENT_NAME": name, **more}


@contextmanager
def navigate(
    robot: LaunchedRobot, name: str, lines: str, *, keep_open: bool = True, attended: str = "1"
) -> Iterator[subprocess.Popen[str]]:
    """keyboard_navigate on a computer of this name, with commands through a pipe."""
    pipe = subprocess.PIPE
    command = [NAVIGATE, f"__name:=navigate_{name}"]
    env = environment(robot, name, UR_ATTENDED=attended)
    process = subprocess.Popen(command, env=env, text=True, stdin=pipe, stdout=pipe, stderr=pipe)
    try:
        assert process.stdin
        process.stdin.write(lines)
        process.stdin.flush()
        if not keep_open:
            process.stdin.close()
            process.stdin = None
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


def kill_on_the_way(robot: LaunchedRobot, name: str) -> None:
    """A program sends the robot away and is killed."""
    put_at_start(robot)
    with navigate(robot, name, FAR) as process:
        robot.ask("moving", seconds=150)
        process.kill()


def test_robot_holds_the_goal_of_a_killed_program_and_goes_on_when_it_is_back(robot: LaunchedRobot) -> None:
    kill_on_the_way(robot, "laptop")
    robot.ask("goals", state="ACTIVE", text="held: no word from laptop for ", seconds=150)
    stand(robot)
    with ProgramTerminal([NAVIGATE, "__name:=back"], environment(robot, "laptop")) as terminal:
        robot.ask("moving", seconds=150)
        robot.ask("goals", state="ACTIVE", text="", seconds=150)
        terminal.wait_for("driving")
        terminal.type("x\r")
        robot.ask("goals", state="PREEMPTED", text="cancelled", seconds=150)
        stand(robot)
        terminal.type("q\r")
        terminal.process.wait(60)


def test_goal_is_cancelled_when_another_computer_takes_over(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    with navigate(robot, "laptop", FAR, keep_open=False) as former:
        robot.ask("moving", seconds=150)
        with navigate(robot, "laptop2", "g 1 0\n", keep_open=False) as second:
            out, _ = second.communicate(timeout=150)
            assert out.startswith("g 1 0: not sent: laptop (keyboard_navigate) drives since ")
            assert second.returncode == 1
        with navigate(robot, "laptop2", "take\ng 0.5 0\n", keep_open=False) as second:
            out, _ = former.communicate(timeout=150)
            assert "laptop2 took over" in out
            assert former.returncode == 1
            out, errors = second.communicate(timeout=150)
            assert (second.returncode, out.splitlines()[0]) == (0, "take: drives now"), errors
            assert "g 0.5 0: reached" in out


def test_screen_says_that_the_robot_is_silent_and_holds_the_goal_open(robot: LaunchedRobot) -> None:
    put_at_start(robot)
    silent = [find_node(robot, name) for name in ("cmd_vel_mux", "move_base")]
    with ProgramTerminal([NAVIGATE, "__name:=at_hand"], environment(robot, "laptop")) as terminal:
        terminal.wait_for("localised")
        terminal.type("g 7.23 10.63\r")
        robot.ask("moving", seconds=150)
        try:
            for pid in silent:
                os.kill(pid, signal.SIGSTOP)
            terminal.wait_for("no word from the robot for 1.")
            terminal.wait_for("goal unknown until it answers")
            stopped = robot.ask("still", seconds=150)
            terminal.wait_for("no word from the robot for 5.")
            assert "failed" not in terminal.text
        finally:
            for pid in silent:
                os.kill(pid, signal.SIGCONT)
        terminal.wait_for("driving")
        assert robot.ask("moving", seconds=150)["true"] != stopped["true"]
        terminal.type("q\r")
        terminal.process.wait(60)
    robot.ask("goals", state="PREEMPTED", text="cancelled", seconds=150)
    stand(robot)
