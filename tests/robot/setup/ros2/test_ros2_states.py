"""The set-up of a robot that has ROS 2: what is found there, and what is written."""

from dataclasses import replace
from pathlib import Path

import pytest

from ur.robot.robot_file import ROBOT_FILE, RobotFile, Ros2Robot, load_robot_file
from ur.robot.ros2.seen_graph import End, Installation, Process, Ros2, SeenGraph, SeenTopic
from ur.robot.setup.access_point import access_point_request
from ur.robot.setup.facts import ABSENT, ComputerFacts, FileState, ServiceState
from ur.robot.setup.robot_states import ViewerFacts, WantedRobot, announcement, robot_file
from ur.robot.setup.ros2.states import find_commands, find_ros2, wanted_on_ros2
from ur.source.diagnostic import UserError

TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
JAZZY = Installation("jazzy", "/opt/ros/jazzy", ("rmw_fastrtps_cpp",))
VIEWER = ViewerFacts("pat", "laptop", f"ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAI{'A' * 43} pat@laptop", None)
FOUND = Ros2Robot("jazzy", "7", "rmw_cyclonedds_cpp", "/robot1", "/robot1/cmd_vel")
BOB = WantedRobot("bob", "stage", ros2=FOUND, master=False)


def process(**variables: str) -> Process:
    return Process(7, "ubuntu", "/opt/ros/jazzy/lib/base/base", "jazzy", "robot.service", variables)


def graph(*topics: SeenTopic) -> SeenGraph:
    return SeenGraph(topics=topics)


def taken(name: str, *nodes: str, kind: str = TWIST) -> SeenTopic:
    return SeenTopic(name, (), tuple(End(node, kind) for node in nodes))


def facts(hostname: str = "bob", present: FileState = ABSENT) -> ComputerFacts:
    wanted = access_point_request("ros")
    files = {**dict.fromkeys(wanted.files, ABSENT), str(ROBOT_FILE): present}
    services = dict.fromkeys(wanted.services, ServiceState())
    return ComputerFacts("ros", "/home/ros", hostname, "", "", frozenset(), files=files, services=services)


def test_domain_middleware_namespace_and_commands_are_those_of_the_nodes() -> None:
    running = process(ROS_DOMAIN_ID="7", RMW_IMPLEMENTATION="rmw_cyclonedds_cpp")
    seen = Ros2((JAZZY,), (running,), graph=graph(taken("/robot1/cmd_vel", "/robot1/base", kind=STAMPED)))
    assert find_ros2("bob", seen) == FOUND


def test_robot_whose_nodes_do_not_run_has_the_settings_of_its_terminals() -> None:
    assert find_ros2("bob", Ros2((JAZZY,), shell={"ROS_DOMAIN_ID": "3"})) == Ros2Robot("jazzy", "3")


def test_robot_without_ros2_has_none() -> None:
    assert find_ros2("bob", Ros2()) is None


def test_robot_with_humble_is_set_up_and_older_ones_are_refused() -> None:
    assert find_ros2("bob", Ros2((replace(JAZZY, distro="humble"),))) == Ros2Robot("humble")
    for old in ("foxy", "iron"):
        with pytest.raises(UserError, match=r"bob: .* is not supported, expected Humble, Jazzy, Kilted or Lyrical"):
            find_ros2("bob", Ros2((replace(JAZZY, distro=old),)))


@pytest.mark.parametrize(
    ("topics", "name"),
    [
        ((), ""),
        ((taken("/scan", "/slam", kind="sensor_msgs/msg/LaserScan"),), ""),
        ((taken("/cmd_vel", "/base"), taken("/cmd_vel_nav", "/collision_monitor")), "/cmd_vel"),
        ((taken("/cmd_vel", "/cmd_vel_mux"), taken("/base/cmd_vel", "/base")), "/base/cmd_vel"),
        ((taken("/diff_drive/cmd_vel_unstamped", "/diff_drive"),), "/diff_drive/cmd_vel_unstamped"),
    ],
)
def test_commands_are_found_where_the_base_listens(topics: tuple[SeenTopic, ...], name: str) -> None:
    assert find_commands(graph(*topics)) == name


def test_robot_file_is_read_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(robot_file(BOB, "devices: []\nros: foxy\nros_domain: 3\n"))
    assert load_robot_file(path) == RobotFile("bob", "stage", "", FOUND)
    assert path.read_text().count("ros_domain") == 1
    assert "devices: []" in path.read_text()


@pytest.mark.parametrize("line", ['ros_domain: "7; reboot"', 'ros_namespace: "../x"', 'ros_middleware: "x"'])
def test_robot_file_with_other_shapes_is_refused(line: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(f'name: bob\nbase: stage\nros: "jazzy"\n{line}\n')
    with pytest.raises(UserError, match="expected such as"):
        load_robot_file(path)


def test_nothing_but_login_name_file_and_announcement_is_changed() -> None:
    titles = [item.title for item in wanted_on_ros2(facts(), BOB, VIEWER, None)]
    assert titles == [
        "ssh folder",
        "login from the viewer",
        "robot file",
        "packages",
        "shared memory outlives logins",
        "names ending in .local",
        "announcement",
    ]
    assert "host name" in [item.title for item in wanted_on_ros2(facts("robot"), BOB, VIEWER, None)]


def test_announcement_names_the_release() -> None:
    assert "<txt-record>ros=jazzy</txt-record>" in announcement(BOB, "ros")
    assert "ros=" not in announcement(WantedRobot("bob", "stage"), "ros").replace("user=ros", "")
