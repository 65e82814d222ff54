"""Launch files of ROS 2 are named as such, and nothing else is said about them."""

import os
from pathlib import Path

import pytest
from tests.forking import run_ur

from ur.launchfile.load import load_plan
from ur.launchfile.syntax import parse_launch_file
from ur.launchfile.world import MemoryWorld

ROS2 = {
    "exec": '<node pkg="demo" exec="talker" name="talker"/>',
    "let": '<group><let name="x" value="1"/></group>',
    "share": '<include file="$(find-pkg-share foo)/launch/b.launch.xml"/>',
    "variable": '<arg name="a"/><node pkg="demo" exec="$(var a)"/>',
}


def _rules(text: str, path: str = "/a.launch") -> list[str]:
    return [found.rule for found in parse_launch_file(path, text.encode()).diagnostics]


@pytest.mark.parametrize("body", ROS2.values(), ids=ROS2)
def test_file_for_ros_2_is_recognised_by_its_content(body: str) -> None:
    assert _rules(f"<launch>{body}</launch>") == ["wrong-ros-version"]


@pytest.mark.parametrize("name", ["/a.launch.py", "/a.launch.yaml", "/a.launch.yml", "/a_launch.py"])
def test_file_for_ros_2_is_recognised_by_its_name(name: str) -> None:
    assert _rules("import launch", name) == ["wrong-ros-version"]


@pytest.mark.parametrize(
    "body",
    [
        '<node pkg="demo" type="talker" name="talker"/>',
        '<node pkg="demo" type="exec" name="exec" args="$(find demo)/exec"/>',
        "<!--In ROS 2: <let name='x' value='1'/> and $(find-pkg-share demo) and exec='a'-->",
        '<param name="help" value="exec"/>',
    ],
)
def test_file_for_ros_1_is_not_taken_for_one_of_ros_2(body: str) -> None:
    assert _rules(f"<launch>{body}</launch>") == []


@pytest.mark.ros
@pytest.mark.parametrize("name", ["a.launch", "a.launch.yaml"])
def test_robot_with_ros_1_is_given_no_advice_about_a_file_for_ros_2(name: str, tmp_path: Path) -> None:
    text = f"<launch>{ROS2['let']}{ROS2['exec']}</launch>" if name == "a.launch" else "launch: []\n"
    (tmp_path / name).write_text(text, encoding="utf-8")
    environment = {**os.environ, "HOME": str(tmp_path), "NO_COLOR": "1", "UR_ROBOT": "sim --ros 1"}
    done = run_ur("launch", name, folder=tmp_path, environment=environment)
    printed = done.stdout + done.stderr
    assert done.returncode != 0
    assert "this is a launch file for ROS 2" in printed
    assert "remove" not in printed
    assert "missing-attribute" not in printed


UNDECIDED = "<launch><arg name='a' default='1'/><group if='true'><include file='b.launch.xml'/></group></launch>"


@pytest.mark.parametrize(
    ("manifest", "is_for_ros2"),
    [
        ("<package><buildtool_depend>ament_cmake</buildtool_depend></package>", True),
        ("<package><export><build_type>ament_python</build_type></export></package>", True),
        ("<package><!-- <buildtool_depend>catkin</buildtool_depend> --><build_type>ament_cmake</build_type>", True),
        ("<package><buildtool_depend>catkin</buildtool_depend></package>", False),
        ("<package><buildtool_depend condition='$ROS_VERSION == 1'>catkin</buildtool_depend>"
         "<buildtool_depend condition='$ROS_VERSION == 2'>ament_cmake</buildtool_depend></package>", False),
        ("<package/>", False),
    ],
)  # fmt: skip
def test_package_decides_for_which_ros_a_file_is_whose_content_does_not(manifest: str, *, is_for_ros2: bool) -> None:
    files = {"/ws/demo/launch/in/a.launch.xml": UNDECIDED, "/ws/demo/package.xml": manifest}
    world = MemoryWorld(files=files)
    path = next(iter(files))
    found = parse_launch_file(path, UNDECIDED.encode(), world.read_bytes).diagnostics
    assert ["its package is built with ament" in each.message for each in found] == [True] * is_for_ros2
    plan = load_plan([path], [], world)
    assert plan.launcher == ("ros2 launch" if is_for_ros2 else "roslaunch")


@pytest.mark.parametrize(
    "body", ['<node pkg="demo" type="talker" name="t"/>', '<include file="$(find demo)/a.launch"/>']
)
def test_content_comes_before_the_package(body: str) -> None:
    ament = b"<package><buildtool_depend>ament_cmake</buildtool_depend></package>"
    assert parse_launch_file("/ws/a.launch.xml", f"<launch>{body}</launch>".encode(), lambda _: ament).diagnostics == ()
