"""A whole drive on ROS 2: the nodes of the launch files, each a process, and a goal as RViz 2 sends it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from tests.ros2_messages import add_messages
from tests.ros2_session import Ros2Session
from tests.ur_nodes.first_drive.drive import read_launch_files

from ur.launchfile.plan.specs import Plan

MODULES = {
    "/simulator": "ur_nodes.simulator.simulator_node",
    "/cmd_vel_mux": "ur_nodes.motion.cmd_vel_mux_node",
    "/map_server": "ur_nodes.mapping.map_server_node",
    "/amcl": "ur_nodes.localisation.amcl_node",
    "/move_base": "ur_nodes.navigation.move_base_node",
}
DRIVER_FOLDER = Path(__file__).parent
DRIVER = str(DRIVER_FOLDER / "goal_driver.py")


def plain(value: Any) -> Any:
    """A value as ROS 2 has it: a list of maps is a map by their `name`, a list of lists a text."""
    if not isinstance(value, list) or not value or not isinstance(value[0], (dict, list)):
        return value
    return {each["name"]: each for each in value} if isinstance(value[0], dict) else json.dumps(value)


def write_parameters(plan: Plan, node: str, file: Path) -> None:
    tree: dict[str, Any] = {}
    for each in plan.params:
        if each.name.startswith(f"{node}/") and each.value not in ([], None):
            *folders, last = each.name.removeprefix(f"{node}/").split("/")
            below = tree
            for folder in folders:
                below = below.setdefault(folder, {})
            below[last] = plain(each.value)
    file.write_text(json.dumps({"/**": {"ros__parameters": tree}}))


def start_robot(session: Ros2Session, tmp_path: Path) -> None:
    """Start the nodes of the launch files."""
    plan = read_launch_files("maze")
    session.environment |= {name: value for node in plan.nodes for name, value in node.env}
    for node in plan.nodes:
        if node.full_name in MODULES:
            file = tmp_path / f"{node.name}.yaml"
            write_parameters(plan, node.full_name, file)
            remaps = [f"{source}:={target}" for source, target in node.remaps]
            session.start(node.name, MODULES[node.full_name], *remaps, "--ros-args", "--params-file", str(file))


@pytest.mark.timeout(150)
def test_robot_drives_to_a_goal_of_rviz(session: Ros2Session, tmp_path: Path) -> None:
    start_robot(session, tmp_path)
    program = session.run("-m", "ur_nodes", DRIVER, within=100.0)
    assert program.stdout, program.stderr
    found = json.loads(program.stdout.splitlines()[-1])
    assert found["end"] == "succeeded: goal reached"
    assert math.dist(found["place"][:2], (0.8, 0.4)) < 0.2
    assert found["planned"] > 1
    for log in tmp_path.glob("*.txt"):
        assert "Traceback" not in log.read_text(), log.name


@pytest.mark.timeout(400)
def test_robot_drives_to_a_goal_of_a_client_of_nav2(session: Ros2Session, tmp_path: Path) -> None:
    add_messages(session.environment)
    start_robot(session, tmp_path)
    session.start("watcher", str(DRIVER_FOLDER / "life_client.py"), "watch")
    command = (str(DRIVER_FOLDER / "navigation/nav2_client.py"), "drive", "0.8", "0.4")
    for _try in range(20):  # until the robot is localised, and answers find the client
        program = session.run(*command, within=100.0)
        assert program.stdout, program.stderr
        found = json.loads(program.stdout.splitlines()[-1])
        if found["status"] == 4 and "place" in found:  # feedback finds the client later than answers do
            break
    assert found["status"] == 4, found
    assert math.dist(found["place"], (0.8, 0.4)) < 0.2
    for log in tmp_path.glob("*.txt"):
        assert "Traceback" not in log.read_text(), log.name
