from __future__ import annotations

from pathlib import Path

import pytest
from tests.forking import add_rosversion, python_of_ros

from ur.launchfile import MemoryWorld, SystemWorld, load_plan
from ur.launchfile.query import dump_params, find_node_file, format_arguments, list_files, list_nodes, read_arguments
from ur.source import UserError

FILE = """<launch>
  <arg name="port"/>
  <!--port: where the robot is-->
  <arg name="speed" default="$(optenv NO_SUCH 1)" doc="metres per second"/>
  <arg name="empty" default=""/>
  <arg name="fixed" value="1"/>
  <param name="a" value="1.5"/>
  <rosparam>b: {c: [1, two]}</rosparam>
  <group ns="g">
    <node pkg="p" type="t" name="first"/>
  </group>
  <test pkg="p" type="t" test-name="second"/>
  <node pkg="p" type="t" name="third"/>
</launch>
"""
ROSLAUNCH = Path("/usr/bin/roslaunch")


@pytest.fixture
def path(tmp_path: Path) -> str:
    (tmp_path / "a.launch").write_text(FILE)
    return str(tmp_path / "a.launch")


def _roslaunch(option: str, path: str) -> str:
    if not ROSLAUNCH.exists():
        pytest.skip("python3-roslaunch is not installed")
    folder = str(Path(path).parent)
    own = {
        "PATH": add_rosversion(Path(folder)),
        "HOME": folder,
        "ROS_HOME": folder,
        "ROS_LOG_DIR": folder,
        "LC_ALL": "C.UTF-8",
    }
    done = python_of_ros().run(str(ROSLAUNCH), *option.split(), path, folder=Path.cwd(), environment=own)
    assert done.returncode == 0, done.stderr
    return done.stdout.decode()


def test_nodes_are_those_that_roslaunch_lists(path: str) -> None:
    ours = list_nodes(load_plan([path], [], SystemWorld()))
    assert ours == ["/g/first", "/third", "/second"]
    assert "\n".join(ours) + "\n" == _roslaunch("--nodes", path)


def test_params_are_printed_as_roslaunch_prints_them(path: str) -> None:
    assert dump_params(load_plan([path], [], SystemWorld())) == _roslaunch("--dump-params", path)


def test_files_and_node_place_are_those_of_roslaunch(path: str) -> None:
    plan = load_plan([path], [], SystemWorld())
    assert "\n".join(list_files(plan)) + "\n" == _roslaunch("--files", path)
    assert find_node_file(plan, "/g/first") + "\n" == _roslaunch("--find-node /g/first", path)


def test_unknown_node_gets_a_suggestion(path: str) -> None:
    with pytest.raises(UserError) as caught:
        find_node_file(load_plan([path], [], SystemWorld()), "/g/frist")
    assert caught.value.diagnostics[0].help == "did you mean /g/first?"


def test_arguments_show_comments_and_empty_defaults() -> None:
    found = read_arguments("/a.launch", [], MemoryWorld({"/a.launch": FILE}))
    assert format_arguments(found) == (
        "Required Arguments:\n  port: where the robot is\nOptional Arguments:\n"
        '  empty (default ""): undocumented\n  speed (default "1"): metres per second\n'
    )
