"""The mux and the detector of lost robots beside a stand-in of Nav2, as `beside_nav2.launch.xml` starts them."""

import json
import signal
from pathlib import Path
from typing import Any

import pytest
from tests.ros2_session import ROOT, Ros2Session

HERE = Path(__file__).parent
PARAMETERS = ROOT / "ubiquity_launches/ros2/params/beside_nav2.yaml"
MUX = ("_base:=stage", "_takes_over:=cmd_vel_nav2", "cmd_vel_out:=cmd_vel")
ELSEWHERE = ("_x:=7.23", "_y:=10.63")

pytestmark = pytest.mark.timeout(240)


@pytest.fixture
def robot(session: Ros2Session) -> Ros2Session:
    """A simulated robot in the maze, its map, the mux, and the detector."""
    world = ROOT / "ubiquity_launches/n_simulator/worlds/maze.yaml"
    session.start("simulator", "ur_nodes.simulator.simulator_node", "_base:=stage", f"_world_file:={world}")
    session.start(
        "map_server", "ur_nodes.mapping.map_server_node", str(ROOT / "ubiquity_launches/n_map_server/maps/maze.yaml")
    )
    given = ("--ros-args", "--params-file", str(PARAMETERS))
    session.start("cmd_vel_mux", "ur_nodes.motion.cmd_vel_mux_node", *MUX, *given)
    session.start("lost_detector", "ur_nodes.localisation.lost_detector_node", "_base_frame_id:=base_footprint", *given)
    return session


def watch(session: Ros2Session, wait: str, *more: str) -> dict[str, Any]:
    program = session.run("-m", "ur_nodes", str(HERE / "beside_watcher.py"), f"_wait:={wait}", *more, within=60.0)
    assert program.stdout, program.stderr
    found: dict[str, Any] = json.loads(program.stdout.splitlines()[-1])
    assert found["seen"], found
    return found


def test_robot_that_is_lost_stops_while_nav2_goes_on_sending_and_drives_once_it_is_found(robot: Ros2Session) -> None:
    robot.start("controller_server", str(HERE / "nav2_controller.py"))
    assert watch(robot, "turning")["lost"] == ""
    carried = watch(robot, "rest", *ELSEWHERE)
    assert carried["lost"].startswith("lost: ")
    assert carried["sent"] > 5
    assert watch(robot, "turning", "_home:=true")["lost"] == ""


def test_robot_rests_when_nav2_is_suspended_or_killed(robot: Ros2Session) -> None:
    controller = robot.start("controller_server", str(HERE / "nav2_controller.py"))
    watch(robot, "turning")
    controller.send_signal(signal.SIGSTOP)
    watch(robot, "rest")
    controller.send_signal(signal.SIGCONT)
    watch(robot, "turning")
    robot.kill(controller)
    watch(robot, "rest")
