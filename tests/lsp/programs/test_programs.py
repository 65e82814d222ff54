"""Parameters and programs of nodes: completion, hover, definitions and uses."""

from __future__ import annotations

from os.path import normpath
from pathlib import Path

import pytest

from ur.check.worlds import make_world
from ur.lsp.completion import complete
from ur.lsp.definitions import find_definitions, find_references
from ur.lsp.hover import describe_at
from ur.lsp.workspace import Workspace

PROGRAM = """#!/usr/bin/env python3
##Summary: Follow a wall.
import rospy
near = rospy.get_param("~near", 0.7)
gain = rospy.get_param("~gain", [1, 2])
"""
FIRST = """<launch>
  <arg name="side" default="left"/>
  <!--side: Where the wall is.-->
  <node name="follow" pkg="my_robot" type="follow_wall">
    <param name="side" value="$(arg side)"/>
    <param name="laps" value="3"/> <!-- how often it goes round -->
    <rosparam file="$(dirname)/../params/follow.yaml"/>
  </node>
</launch>
"""
YAML = """# Parameters of the office.

# How fast it drives, in m/s.
speed: 0.5
near: 0.9
turn:
  rate: 1.0 # rad/s
"""
STARTER = (
    "#!/bin/bash\n##Summary: Follow.\n##Overview: A wall.\n"
    'exec ur launch my_robot first.launch \\\n  side:=right "$@"\n'
)


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    package = tmp_path / "my_robot"
    texts = {
        "package.xml": "<package><name>my_robot</name></package>",
        "launch/first.launch": FIRST,
        "params/follow.yaml": YAML,
        "scripts/follow_wall": PROGRAM,
        "bin/ur_follow": STARTER,
    }
    for name, text in texts.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text)
    for name in ("scripts/follow_wall", "bin/ur_follow"):
        (package / name).chmod(0o755)
    return Workspace([str(package)], lambda paths: make_world(paths, {"ROS_PACKAGE_PATH": str(tmp_path)}))


def place(workspace: Workspace, name: str, text: str) -> tuple[Workspace, str, int]:
    """A file, whose text is changed so that it contains `text` without its bar, and the bar's place."""
    path = f"{workspace.folders[0]}/{name}"
    plain = text.replace("|", "")
    if name.endswith("new.launch"):
        workspace.set_text(path, f"<launch>{plain}</launch>")
    return workspace, path, workspace.source(path).text.index(plain) + text.index("|")


def names_of(workspace: Workspace, spans: list[object]) -> list[str]:
    return [normpath(str(each)).removeprefix(workspace.folders[0] + "/") for each in spans]


NODE = '<node name="b" pkg="my_robot" type="follow_wall">'


def test_parameters_of_a_program_are_completed_with_documentation(workspace: Workspace) -> None:
    found = complete(*place(workspace, "launch/new.launch", f'{NODE}<param name="|"/></node>'))
    assert {each.label: (each.help, each.document) for each in found} == {
        "side": ("left", "Where the wall is."),
        "laps": ("3", "how often it goes round"),
        "speed": ("0.5", "How fast it drives, in m/s."),
        "near": ("0.9", "How fast it drives, in m/s."),
        "turn/rate": ("1.0", "rad/s"),
        "gain": ("[1, 2]", ""),
    }
    found = complete(*place(workspace, "launch/new.launch", f'{NODE}<param name="near" value="|"/></node>'))
    assert [each.label for each in found] == ["0.9", "0.7"]
    found = complete(*place(workspace, "params/follow.yaml", "\nne|ar:"))


def test_yaml_file_gets_the_parameters_of_the_program_that_loads_it(workspace: Workspace) -> None:
    path = f"{workspace.folders[0]}/params/follow.yaml"
    workspace.set_text(path, "ga\n")
    assert [each.insert for each in complete(workspace, path, 2)] == ["gain: "]


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        (
            "launch/first.launch",
            '<param name="si|de"',
            "**side** of `follow_wall`\n\nWhere the wall is.\n\n- `left` in",
        ),
        ("params/follow.yaml", "ne|ar", "- `0.9` in follow.yaml\n- `0.7` in its source"),
        ("params/follow.yaml", "ra|te: 1.0", "rad/s"),
    ],
)
def test_hover_describes_a_parameter(workspace: Workspace, name: str, text: str, words: str) -> None:
    found = describe_at(*place(workspace, name, text))
    assert found is not None
    assert words in found[0]


@pytest.mark.parametrize(
    ("name", "text", "definitions", "references"),
    [
        (
            "params/follow.yaml",
            "ne|ar",
            ["scripts/follow_wall:4:26"],
            ["params/follow.yaml:5:1", "scripts/follow_wall:4:26"],
        ),
        ("launch/first.launch", '<param name="la|ps"', ["launch/first.launch:6:5"], ["launch/first.launch:6:5"]),
        ("launch/first.launch", 'type="follow|_wall"', ["scripts/follow_wall:1:1"], ["launch/first.launch:4:44"]),
        ("scripts/follow_wall", "imp|ort", [], []),
    ],
)
def test_definitions_and_uses_cross_files(
    workspace: Workspace, name: str, text: str, definitions: list[str], references: list[str]
) -> None:
    here = place(workspace, name, text)
    assert names_of(workspace, [*find_definitions(*here)]) == definitions
    assert names_of(workspace, [*find_references(*here)]) == references


def test_launch_file_knows_the_programs_that_start_it(workspace: Workspace) -> None:
    include = '<include file="$(find my_robot)/launch/first|.launch"/>'
    found = find_references(*place(workspace, "launch/new.launch", include))
    assert "bin/ur_follow:4:25" in names_of(workspace, [*found])


@pytest.mark.usefixtures("workspace")
def test_node_of_another_package_gets_the_parameters_of_that_package(tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    (other / "package.xml").write_text("<package><name>other</name></package>")
    opened = Workspace([str(other)], lambda paths: make_world(paths, {"ROS_PACKAGE_PATH": str(tmp_path)}))
    found = complete(*place(opened, "new.launch", f'{NODE}<param name="sp|"/></node>'))
    assert [(each.label, each.document) for each in found] == [("speed", "How fast it drives, in m/s.")]
