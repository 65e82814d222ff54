from pathlib import Path

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.query.arguments import format_arguments, read_arguments
from ur.launchfile.query.explain import find_node_file
from ur.launchfile.world.memory import MemoryWorld
from ur.launchfile.world.system import SystemWorld
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


@pytest.fixture
def path(tmp_path: Path) -> str:
    (tmp_path / "a.launch").write_text(FILE)
    return str(tmp_path / "a.launch")


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
