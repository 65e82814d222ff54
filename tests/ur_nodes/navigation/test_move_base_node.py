from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.ros_session import Client, free_port

ROOT = Path(__file__).parents[3]
LAUNCH = """<launch>
  <include file="{root}/ubiquity_launches/n_move_base/launch/n_move_base.launch.xml">
    <arg name="robot_base" value="stage"/>
    <arg name="cmd_vel" value="cmd_vel"/>
    <arg name="scan" value="{scan}"/>
  </include>
  <param name="move_base/controller_patience" value="1.0"/>
  <param name="move_base/on_return" value="{on_return}"/>
</launch>
"""

pytestmark = pytest.mark.ros


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    with start_robot(tmp_path_factory.mktemp("move_base"), scan="scan") as robot:
        yield robot


@pytest.fixture
def blind_robot(tmp_path: Path) -> Iterator[Client]:
    """One without a lidar."""
    with start_robot(tmp_path, scan="") as robot:
        robot.ask("blind", blind=True)
        yield robot


@contextmanager
def start_robot(folder: Path, scan: str, *client_arguments: str, on_return: str = "resume") -> Iterator[Client]:
    port = free_port()
    environment = {name: value for name, value in os.environ.items() if not name.startswith("ROS")} | {
        "ROS_MASTER_URI": f"http://localhost:{port}",
        "ROS_HOSTNAME": "localhost",
        "ROS_HOME": str(folder / "home"),
        "ROS_LOG_DIR": str(folder / "log"),
        "ROS_PACKAGE_PATH": f"{ROOT / 'ubiquity_launches'}:/usr/share",
        "PYTHONPATH": f"{ROOT}:{ROOT / 'src'}",
    }
    (folder / "test.launch").write_text(LAUNCH.format(root=ROOT, scan=scan, on_return=on_return))
    with (folder / "launch.log").open("w") as log:
        launch = subprocess.Popen(
            ["/usr/bin/roslaunch", "-p", str(port), str(folder / "test.launch")],
            env=environment,
            stdout=log,
            stderr=log,
        )
    client = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("robot_client_node.py")), *client_arguments],
        env=environment,
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    try:
        robot = Client(client)
        robot.ask("ready", seconds=60.0)
        yield robot
    finally:
        client.kill()
        client.communicate()
        launch.send_signal(signal.SIGINT)
        try:
            launch.wait(60)
        finally:
            launch.kill()
            launch.wait()


def test_move_base_reaches_a_goal_and_is_silent_afterwards(robot: Client) -> None:
    robot.ask("goal", name="a", x=0.8, y=0.4, yaw=1.57)
    end = robot.ask("end", name="a", seconds=60.0)
    assert end["state"] == "SUCCEEDED"
    assert end["text"] == "goal reached"
    assert math.hypot(end["x"] - 0.8, end["y"] - 0.4) < 0.1
    assert abs(end["yaw"] - 1.57) < 0.09
    assert robot.ask("commands")["commands"] <= 1
    seen = robot.ask("seen", seconds=60.0)
    assert seen["costmap"] == 84 * 124


def test_move_base_stops_when_a_goal_is_cancelled(robot: Client) -> None:
    robot.ask("goal", name="b", x=-0.8, y=-1.0)
    robot.ask("moving", seconds=60.0)
    robot.ask("cancel", name="b")
    assert robot.ask("end", name="b", seconds=60.0)["state"] == "PREEMPTED"
    robot.ask("stopped", seconds=60.0)


def test_move_base_lets_a_new_goal_replace_the_old_one(robot: Client) -> None:
    robot.ask("goal", name="c", x=3.0, y=0.0)
    robot.ask("moving", seconds=60.0)
    robot.ask("goal", name="d", x=0.0, y=0.0)
    old = robot.ask("end", name="c", seconds=60.0)
    assert old["state"] == "PREEMPTED"
    assert "replaced" in old["text"]
    assert robot.ask("end", name="d", seconds=60.0)["state"] == "SUCCEEDED"


@pytest.mark.parametrize(
    ("goal", "reason"),
    [
        ({"x": 1.5, "y": -1.0}, "the goal (1.50, -1.00) is in a wall"),
        ({"x": 50.0, "y": 0.0}, "outside the map"),
        ({"x": 0.5, "y": 0.0, "norm": 0.0}, "not a unit quaternion"),
        ({"x": math.nan, "y": 0.0}, "not finite"),
    ],
)
def test_move_base_says_why_a_goal_cannot_be_reached(robot: Client, goal: dict[str, float], reason: str) -> None:
    robot.ask("goal", name="e", **goal)
    end = robot.ask("end", name="e", seconds=60.0)
    assert end["state"] == "ABORTED"
    assert reason in end["text"]


def test_move_base_takes_simple_goals(robot: Client) -> None:
    robot.ask("simple_goal", x=-0.8, y=0.8)
    robot.ask("moving", seconds=60.0)
    robot.ask("goal", name="f", x=-0.5, y=0.5)
    robot.ask("end", name="f", seconds=60.0)


def test_move_base_makes_plans_without_driving(robot: Client) -> None:
    points = robot.ask("make_plan", x=3.0, y=-1.0)["points"]
    assert points[-1] == pytest.approx([3.0, -1.0], abs=0.05)
    assert all(0.4 < y < 1.3 for x, y in points if 1.45 < x < 1.55), "through the door"
    assert robot.ask("make_plan", x=1.5, y=-1.0)["points"] == []
    robot.ask("clear")


def test_move_base_stops_and_gives_up_when_the_scan_falls_silent(robot: Client) -> None:
    robot.ask("goal", name="g", x=1.0, y=-1.5)
    robot.ask("moving", seconds=60.0)
    robot.ask("blind", blind=True)
    try:
        end = robot.ask("end", name="g", seconds=60.0)
    finally:
        robot.ask("blind", blind=False)
    assert end["state"] == "ABORTED"
    assert "no scan on /scan for" in end["text"]
    assert math.hypot(end["x"] - 1.0, end["y"] + 1.5) > 0.2


def test_move_base_without_a_scan_drives_on_the_map_alone(blind_robot: Client) -> None:
    blind_robot.ask("goal", name="a", x=3.0, y=-1.0, yaw=1.57)  # in the other room, through the door
    end = blind_robot.ask("end", name="a", seconds=60.0)
    assert end["state"] == "SUCCEEDED", end["text"]
    assert math.hypot(end["x"] - 3.0, end["y"] + 1.0) < 0.1


def test_move_base_without_a_scan_goes_round_what_a_sonar_hears(blind_robot: Client) -> None:
    blind_robot.ask("pillar", x=0.0, y=0.9)
    blind_robot.ask("goal", name="a", x=0.0, y=1.6, yaw=1.57)
    end = blind_robot.ask("end", name="a", seconds=90.0)
    assert end["state"] == "SUCCEEDED", end["text"]
    assert blind_robot.ask("nearest")["nearest"] > 0.19  # the robot's half width
