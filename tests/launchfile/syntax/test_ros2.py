"""Launch files of ROS 2 are named as such, and nothing else is said about them."""

import os
from pathlib import Path

import pytest
from tests.forking import run_ur

from ur.launchfile.syntax import parse_launch_file

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
