"""What editors ask at a place of a launch file: completion, hover, definitions and actions."""

from pathlib import Path

import pytest

from ur.check.worlds import make_world
from ur.lsp.completion import complete
from ur.lsp.definitions import find_definitions, find_references
from ur.lsp.hover import describe_at
from ur.lsp.workspace import Workspace

PART = """<launch>
  <!--Summary: Sets the speed.-->
  <arg name="speed"/>
  <!--speed: How fast it drives.-->
  <arg name="rate" default="3"/>
  <param name="speed" value="$(arg speed)"/>
</launch>
"""


class EditedText:
    """A workspace with a launch file, and the place of the bar in its text."""

    def __init__(self, folder: Path, text: str) -> None:
        package = folder / "my_robot"
        (package / "launch").mkdir(parents=True)
        (package / "scripts").mkdir()
        (package / "package.xml").write_text("<package><name>my_robot</name></package>")
        (package / "launch/part.launch.xml").write_text(PART)
        program = package / "scripts/talk"
        program.write_text("#!/bin/sh\n")
        program.chmod(0o755)
        environment = {"HOME": "/home/robot", "ROS_PACKAGE_PATH": str(folder)}
        self.workspace = Workspace([str(package)], lambda paths: make_world(paths, environment))
        self.path = str(package / "launch/top.launch")
        self.workspace.set_text(self.path, text.replace("|", ""))
        self.offset = text.index("|")


@pytest.mark.parametrize(
    ("text", "labels"),
    [
        ("<laun|", ["launch"]),
        ("<launch><par|</launch>", ["param"]),
        ('<launch><node pkg="a" type="b" na|/></launch>', ["name"]),
        ('<launch><node pkg="a" type="b" name="c" output="|"/></launch>', ["log", "screen"]),
        ('<launch><node pkg="my_|" type="" name="c"/></launch>', ["my_robot"]),
        ('<launch><node pkg="my_robot" type="|" name="c"/></launch>', ["talk"]),
        ('<launch><arg name="a" default="1"/><param name="p" value="$(arg |)"/></launch>', ["a"]),
        ('<launch><param name="p" value="$(fin|"/></launch>', ["find"]),
        ('<launch><param name="p" value="$(find my|"/></launch>', ["my_robot"]),
        ('<launch><param name="p" value="$(optenv HO|"/></launch>', ["HOME"]),
        ('<launch><include file="$(find my_robot)/la|"/></launch>', ["launch/"]),
        ('<launch><include file="$(find my_robot)/launch/pa|"/></launch>', ["part.launch.xml"]),
        (
            '<launch><include file="$(find my_robot)/launch/part.launch.xml"><arg name="|"/></include></launch>',
            ["speed", "rate"],
        ),
        (
            '<launch><arg name="speed" default="1"/><include file="$(dirname)/part.launch.xml">'
            '<arg name="speed" value="|"/></include></launch>',
            ["$(arg speed)"],
        ),
        (
            '<launch><machine name="bob" address="bob.local"/><node pkg="a" type="b" name="c" machine="|"/></launch>',
            ["bob"],
        ),
        ("<launch><!-- |--></launch>", []),
    ],
)
def test_completion_offers_what_fits(tmp_path: Path, text: str, labels: list[str]) -> None:
    here = EditedText(tmp_path, text)
    found = [each.label for each in complete(here.workspace, here.path, here.offset)]
    assert [each for each in found if each in labels] == labels
    assert labels or not found


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('<launch><no|de pkg="a" type="b" name="c"/></launch>', ""),
        ('<launch><node pkg="my_robot" type="talk" name="c" out|put="log"/></launch>', "One of"),
        ('<launch><node pkg="my_ro|bot" type="talk" name="c"/></launch>', "package `my_robot`"),
        ('<launch><node pkg="my_robot" type="ta|lk" name="c"/></launch>', "scripts/talk"),
        ('<launch><node pkg="my_robot" type="talk" name="c|"/></launch>', "c"),
        ('<launch><include file="$(dirname)/part.la|unch.xml"/></launch>', "Sets the speed."),
        (
            '<launch><include file="$(dirname)/part.launch.xml"><arg name="sp|eed" value="1"/></include></launch>',
            "How fast it drives.",
        ),
        ('<launch><param name="p" value="$(arg no|thing)"/></launch>', "not declared"),
    ],
)
def test_hover_describes_a_thing(tmp_path: Path, text: str, words: str) -> None:
    here = EditedText(tmp_path, text)
    found = describe_at(here.workspace, here.path, here.offset)
    assert found is not None
    assert words in found[0]


@pytest.mark.parametrize(
    ("text", "files", "references"),
    [
        ('<launch><node pkg="my_robot" type="ta|lk" name="c"/></launch>', ["talk"], ["top.launch"]),
        ('<launch><node pkg="my_rob|ot" type="talk" name="c"/></launch>', ["package.xml"], ["top.launch"]),
        ('<launch><include file="$(dirname)/part.la|unch.xml"/></launch>', ["part.launch.xml"], ["top.launch"]),
        ('<launch><node pkg="my_robot" type="talk" name="c|"/></launch>', ["top.launch"], ["top.launch"]),
        ('<launch><param name="sp|eed" value="2"/></launch>', None, ["part.launch.xml", "top.launch"]),
        ("<launch>|</launch>", [], []),
    ],
)
def test_definitions_and_references_are_found(
    tmp_path: Path, text: str, files: list[str] | None, references: list[str]
) -> None:
    here = EditedText(tmp_path, text)
    found = find_definitions(here.workspace, here.path, here.offset)
    if files is not None:
        assert sorted({Path(each.file.path).name for each in found}) == files
    places = find_references(here.workspace, here.path, here.offset)
    assert sorted({Path(each.file.path).name for each in places}) == references
