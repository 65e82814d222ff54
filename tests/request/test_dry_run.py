"""What `ur launch` shows of a launch file of ROS 2, and that it does not start it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ur.cli.main import main

FILE = """from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, RegisterEventHandler, TimerAction
from launch.event_handlers import OnProcessExit
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import ComposableNodeContainer, Node
from launch_ros.descriptions import ComposableNode


def generate_launch_description():
    spawn = ExecuteProcess(cmd=['spawn', 'robot'])
    camera = ComposableNode(package='cam', plugin='cam::Camera', name='camera', namespace='front')
    return LaunchDescription([
        DeclareLaunchArgument('mode', default_value='slow', choices=['slow', 'fast'], description='How it drives.'),
        DeclareLaunchArgument('map'),
        spawn,
        Node(package='demo', executable='driver', name='driver', namespace='base', remappings=[('scan', '/scan')],
             parameters=['/etc/hostname', {'mode': LaunchConfiguration('mode'), 'rate': 5}]),
        TimerAction(period=5.0, actions=[Node(package='demo', executable='late', respawn=True, respawn_delay=2.0)]),
        RegisterEventHandler(OnProcessExit(target_action=spawn, on_exit=[Node(package='demo', executable='after')])),
        ComposableNodeContainer(package='rclcpp_components', executable='component_container', name='box',
                                namespace='', composable_node_descriptions=[camera]),
    ])
"""


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A launch file in Python."""
    monkeypatch.setenv("HOME", str(tmp_path))
    path = tmp_path / "robot.launch.py"
    path.write_text(FILE, encoding="utf-8")
    return str(path)


def test_dry_run_has_a_command_line_for_each_node(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["launch", "--dry-run", file, "mode:=fast", "map:=office"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "# spawn",
        "spawn robot",
        "# /base/driver",
        "ros2 run demo driver --ros-args -r __node:=driver -r __ns:=/base -r scan:=/scan --params-file /etc/hostname"
        " -p 'mode:=\"fast\"' -p rate:=5",
        "# /box",
        "ros2 run rclcpp_components component_container --ros-args -r __node:=box",
        "# /front/camera, in /box",
        "ros2 component load /box cam cam::Camera -n camera --node-namespace /front",
        "# /late, after 5 s, again 2 s after its end",
        "ros2 run demo late",
        "# /after, when /spawn ends",
        "ros2 run demo after",
    ]


def test_arguments_have_their_descriptions_and_choices(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["launch", "--show-args", file]) == 0
    assert capsys.readouterr().out == (
        "Required Arguments:\n  map: undocumented\n"
        'Optional Arguments:\n  mode (default "slow"): How it drives. (one of slow, fast)\n'
    )


def test_start_with_ros1_selected_is_refused_with_the_command_that_installs_ros2(
    file: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("UR_ROBOT", "sim --ros 1")
    assert main(["launch", "--plain", file, "map:=office"]) != 0
    printed = capsys.readouterr().err
    assert "this is a launch file for ROS 2, and ROS 1 is selected" in printed
    assert "ur use sim --ros 2" in printed


def test_file_that_its_package_alone_shows_to_be_for_ros2_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("UR_ROBOT", "sim --ros 1")
    (tmp_path / "package.xml").write_text("<package><buildtool_depend>ament_cmake</buildtool_depend></package>")
    (tmp_path / "a.launch.xml").write_text("<launch><arg name='a' default='1'/></launch>")
    assert main(["launch", "--plain", str(tmp_path / "a.launch.xml")]) != 0
    printed = capsys.readouterr().err
    assert "this is a launch file for ROS 2, and ROS 1 is selected" in printed
    assert "this is a launch file for ROS 2 (its package is built with ament)" in printed


def test_origin_of_an_argument_and_a_parameter_is_explained(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", file, "map:=office", "mode"]) == 0
    text = capsys.readouterr().out
    assert f"{file}:13:31: argument mode = 'slow'\n" in text
    assert "parameter /base/driver/mode = 'slow'\n" in text


def test_page_of_a_package_has_arguments_nodes_and_their_starts(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["docs", str(Path(file).parent), "--output", "-"]) == 0
    text = capsys.readouterr().out
    assert "| `mode` | slow or fast | `slow` | How it drives. |" in text
    assert "component in `/box`" in text
    assert "starts when /spawn ends" in text
    assert "ros2 launch " in text
    assert "roslaunch" not in text


def test_dump_has_containers_and_what_nodes_wait_for(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["launch", "--dump", "json", file, "map:=office"]) == 0
    dumped = json.loads(capsys.readouterr().out)
    nodes = {each["name"]: each for each in dumped["nodes"]}
    assert (nodes["/front/camera"]["kind"], nodes["/front/camera"]["container"]) == ("component", "/box")
    assert nodes["/late"]["starts"] == "after 5 s"
    assert dumped["params"]["/base/driver/rate"] == 5


def test_lifecycle_node_that_starts_itself_says_so(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    body = "[LifecycleNode(package='demo', executable='life', name='n', namespace='', autostart=True)]"
    text = "from launch import LaunchDescription\nfrom launch_ros.actions import LifecycleNode\n"
    text += f"def generate_launch_description():\n    return LaunchDescription({body})\n"
    Path(file).write_text(text, encoding="utf-8")
    assert main(["launch", "--dry-run", file]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "# /n, lifecycle node, then configured and activated"
