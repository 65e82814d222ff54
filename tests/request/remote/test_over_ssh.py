"""The command line of a program that runs on a robot with ROS 2."""

from __future__ import annotations

from ur.request.remote.over_ssh import program_arguments, remote_script
from ur.robot.robot_file import RobotFile, Ros2Robot

ROS2 = Ros2Robot("jazzy", "7", "rmw_cyclonedds_cpp", "/robot1", "/robot1/cmd_vel")
BOB = RobotFile("bob", "stage", "", ROS2)
DECLARED = ("robot_base", "robot_variant", "start_drivers", "cmd_vel", "obstacle_stop")


def test_drivers_that_run_already_are_not_started_and_the_base_gets_its_commands() -> None:
    made = program_arguments(BOB, ["obstacle_stop:=false"], DECLARED)
    assert made == ["obstacle_stop:=false", "robot_base:=stage", "start_drivers:=false", "cmd_vel:=/robot1/cmd_vel"]


def test_arguments_of_the_user_and_undeclared_ones_are_left_alone() -> None:
    assert program_arguments(BOB, ["cmd_vel:=x"], ("cmd_vel",)) == ["cmd_vel:=x"]


def test_program_gets_the_domain_and_middleware_of_the_nodes() -> None:
    script = remote_script("bob", ROS2, ["run", "keyboard_drive", "a:=b c"], "/dev/shm/x")
    for part in (
        "/opt/ros/jazzy/setup.bash",
        "UR_ROBOT=bob",
        "ROS_DOMAIN_ID=7",
        "RMW_IMPLEMENTATION=rmw_cyclonedds_cpp",
    ):
        assert part in script
    assert "UR_LINK=/dev/shm/x" in script
    assert "UR_LINK" not in remote_script("bob", ROS2, ["web"])
