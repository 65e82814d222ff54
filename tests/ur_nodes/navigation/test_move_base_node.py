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
  </include>
  <param name="move_base/controller_patience" value="1.0"/>
</launch>
"""

pytestmark = pytest.mark.ros


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    with start_robot(tmp_path_factory.mktemp("move_base")) as robot:
        yield robot


@contextmanager
def start_robot(folder: Path) -> Iterator[Client]:
    port = free_port()
    environment = {name: value for name, value in os.environ.items() if not name.startswith("ROS")} | {
        "ROS_MASTER_URI": f"http://localhost:{port}",
        "ROS_HOSTNAME": "localhost",
        "ROS_HOME": str(folder / "home"),
        "ROS_LOG_DIR": str(folder / "log"),
        "ROS_PACKAGE_PATH": f"{ROOT / 'ubiquity_launches'}:/usr/share",
        "PYTHONPATH": f"{ROOT}:{ROOT / 'src'}",
    }
    (folder / "test.launch").write_text(LAUNCH.format(root=ROOT))
    with (folder / "launch.log").open("w") as log:
        launch = subprocess.Popen(
            ["/usr/bin/roslaunch", "-p", str(port), str(folder / "test.launch")],
            env=environment,
            stdout=log,
            stderr=log,
        )
    client = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("robot_client_node.py"))],
        env=environment,
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    try:
        robot = Client(client)
        robot.ask("ready", seconds=150.0)
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


def test_move_base_serves_clients_of_upstream(robot: Client) -> None:
    robot.ask("goal", name="a", x=0.8, y=0.4, yaw=1.57)
    end = robot.ask("end", name="a", seconds=60.0)
    assert (end["state"], end["text"]) == ("SUCCEEDED", "goal reached")
    assert math.hypot(end["x"] - 0.8, end["y"] - 0.4) < 0.1
    assert robot.ask("seen", seconds=60.0)["costmap"] == 84 * 124
    robot.ask("simple_goal", x=-0.8, y=-1.0)
    robot.ask("moving", seconds=60.0)
    robot.ask("goal", name="b", x=-1.0, y=-1.0)
    robot.ask("pursued", name="b", seconds=60.0)
    robot.ask("cancel", name="b")
    assert robot.ask("end", name="b", seconds=60.0)["state"] == "PREEMPTED"
    robot.ask("goal", name="c", x=0.5, y=0.0, norm=0.0)
    end = robot.ask("end", name="c", seconds=60.0)
    assert end["state"] == "ABORTED"
    assert "not a unit quaternion" in end["text"]
    assert robot.ask("make_plan", x=3.0, y=-1.0)["points"][-1] == pytest.approx([3.0, -1.0], abs=0.05)
    assert robot.ask("make_plan", x=1.5, y=-1.0)["points"] == []
    robot.ask("clear")


def test_move_base_offers_the_topics_of_upstream(robot: Client) -> None:
    topics = {(name, kind) for name, kind in robot.ask("topics") if name.startswith(("/move_base/", "/cmd_vel"))}
    live = (
        "",
        "DWAPlannerROS/",
        "GlobalPlanner/",
        "NavfnROS/",
        *(f"{each}_costmap/inflation_layer/" for each in ("global", "local")),
    )
    assert topics == {
        *((f"/move_base/{folder}parameter_updates", "dynamic_reconfigure/Config") for folder in live),
        *((f"/move_base/{folder}parameter_descriptions", "dynamic_reconfigure/ConfigDescription") for folder in live),
        ("/cmd_vel", "geometry_msgs/Twist"),
        ("/cmd_vel_stamped", "geometry_msgs/TwistStamped"),
        ("/move_base/DWAPlannerROS/global_plan", "nav_msgs/Path"),
        ("/move_base/DWAPlannerROS/local_plan", "nav_msgs/Path"),
        ("/move_base/NavfnROS/plan", "nav_msgs/Path"),
        ("/move_base/cancel", "actionlib_msgs/GoalID"),
        ("/move_base/current_goal", "geometry_msgs/PoseStamped"),
        ("/move_base/feedback", "move_base_msgs/MoveBaseActionFeedback"),
        ("/move_base/global_costmap/costmap", "nav_msgs/OccupancyGrid"),
        ("/move_base/global_costmap/costmap_updates", "map_msgs/OccupancyGridUpdate"),
        ("/move_base/global_costmap/footprint", "geometry_msgs/PolygonStamped"),
        ("/move_base/goal", "move_base_msgs/MoveBaseActionGoal"),
        ("/move_base/hold", "std_msgs/String"),
        ("/move_base/local_costmap/costmap", "nav_msgs/OccupancyGrid"),
        ("/move_base/local_costmap/footprint", "geometry_msgs/PolygonStamped"),
        ("/move_base/result", "move_base_msgs/MoveBaseActionResult"),
        ("/move_base/status", "actionlib_msgs/GoalStatusArray"),
    }
