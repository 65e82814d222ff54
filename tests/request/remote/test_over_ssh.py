"""The command line of a program that runs on a robot with ROS 2."""

import struct
import subprocess
import time
from pathlib import Path
from typing import cast

import pytest

from ur.request.remote.over_ssh import guard_link, program_arguments, read_robot, remote_script
from ur.robot.robot_file import RobotFile, Ros2Robot
from ur.robot.ssh.address import Address
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.shell import ShellResult
from ur.source.diagnostic import UserError

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


class LocalRobotShell:
    """A robot on this computer: its shell runs programs here, and prints a robot file."""

    destination = "bob.local"

    def __init__(self, text: str) -> None:
        self.text = text
        self.address = Address("me", "bob.local")

    def run(self, _script: str) -> ShellResult:
        return ShellResult(0 if self.text else 1, self.text, "")

    def start(self, script: str) -> subprocess.Popen[bytes]:
        return subprocess.Popen(["bash", "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE)


def test_robot_tells_its_base_and_its_ros2() -> None:
    text = "name: bob\nbase: stage\nros: jazzy\nros_domain: '7'\nros_commands: /cmd_vel\n"
    found, ros2 = read_robot(cast(SshShell, LocalRobotShell(text)))
    assert (found.name, found.base, ros2.distro, ros2.commands) == ("bob", "stage", "jazzy", "/cmd_vel")


@pytest.mark.parametrize("text", ["", "name: bob\nbase: stage\n"])
def test_robot_without_ros2_is_to_be_set_up(text: str) -> None:
    with pytest.raises(UserError, match="names no release of ROS 2, expected one") as problem:
        read_robot(cast(SshShell, LocalRobotShell(text)))
    assert problem.value.diagnostics[0].help == "ur robot setup bob"


def test_connection_is_proven_while_the_context_lasts() -> None:
    with guard_link(cast(SshShell, LocalRobotShell(""))) as link:
        end = time.monotonic() + 30
        while not Path(link).exists() or not Path(link).read_bytes():
            assert time.monotonic() < end
        assert struct.unpack("d", Path(link).read_bytes())[0] <= time.monotonic()
