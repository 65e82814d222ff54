"""A recording in place of the robot."""

from pathlib import Path

import pytest

from ur.launchfile.world.system import SystemWorld
from ur.request.joining.replaying import find_robot_nodes, plan_replay
from ur.robot.selection import Selection
from ur.source.arguments import Argument
from ur.source.project import launch_library

WORLD = SystemWorld({"ROS_PACKAGE_PATH": str(launch_library().parent), "HOME": "/home/robot"})
NAVIGATE = str(launch_library() / "m_keyboard_navigate/launch/m_keyboard_navigate.launch.xml")


def test_nodes_of_the_robot_are_left_out() -> None:
    selection = Selection(base="magni", variant="lidar")
    nodes = find_robot_nodes(NAVIGATE, (), selection, WORLD)
    assert {"/move_base", "/amcl", "/map_server", "/simulator", "/cmd_vel_mux"} <= set(nodes)
    assert not {"/keyboard_navigate", "/rviz"} & set(nodes)


def test_launch_has_the_replay_first_and_its_arguments() -> None:
    given = (Argument("use_rviz", "false"), Argument("robot_machine", "bob"))
    launch = plan_replay(Path("/a/b.mcap"), NAVIGATE, given, Selection(), WORLD, playback=(2.0, 30.0))
    file, program, *arguments = launch.line.argv
    assert (file.rpartition("/")[2], program) == ("n_replay.launch.xml", NAVIGATE)
    assert arguments == ["recording:=/a/b.mcap", "playback_speed:=2", "playback_start:=30", "use_rviz:=false"]
    assert "/move_base" in launch.left_out


@pytest.mark.parametrize("name", ["n_amcl/launch/n_amcl.launch.xml"])
def test_file_without_a_robot_is_started_as_it_is(name: str) -> None:
    assert find_robot_nodes(str(launch_library() / name), (), Selection(), WORLD) == ()
    assert plan_replay(Path("/b.mcap"), "", (), Selection(), WORLD, playback=(1.0, 0.0)).left_out == ()
