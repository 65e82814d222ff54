"""Comments as doc= attributes: roslaunch shows them, nothing else changes."""

import shutil
import subprocess
from pathlib import Path

import pytest
from tests.docs.helpers import LIBRARY

from ur.docs.doc_attributes import add_doc_attributes
from ur.launchfile.load import load_plan
from ur.launchfile.syntax import parse_launch_file
from ur.launchfile.world import MemoryWorld

ROSLAUNCH = shutil.which("roslaunch")
TEXT = """<?xml version="1.0"?>
<!-- A head. -->
<launch>
\t<arg   name = "plain"/>   <!--plain: A plain one, in "quotes" & with <tags> and $(arg nothing).-->
  <arg name='single' default='1' />
  <!--single: Two
      lines, with `code`.-->
  <arg
    name="many"
    default="$(arg single)"
  />
  <!--many: Attributes in many lines.-->
  <arg name="kept" default="" doc="Says itself."/>
  <arg name="stale" doc="Something old." default="2"/>
  <!--stale: Something new.-->
  <arg name="silent" default="3"/>
  <!--other: Not about it.-->
  <node name="n" pkg="p" type="t"><!--plain: no--></node>
</launch>
"""


def rewrite(text: str) -> str:
    return add_doc_attributes(parse_launch_file("/a.launch", text.encode()))


def test_attributes_are_added_and_everything_else_stays() -> None:
    changed = rewrite(TEXT)
    doc = "A plain one, in &quot;quotes&quot; &amp; with &lt;tags&gt; and $ (arg nothing)."
    assert changed == (
        TEXT.replace('name = "plain"', f'name = "plain" doc="{doc}"')
        .replace("default='1' />", "default='1' doc=\"Two lines, with `code`.\" />")
        .replace('default="$(arg single)"\n', 'default="$(arg single)"\n    doc="Attributes in many lines."\n')
        .replace("Something old.", "Something new.")
    )


def test_second_time_changes_nothing() -> None:
    once = rewrite(TEXT)
    assert rewrite(once) == once


def test_line_ends_and_broken_files_stay() -> None:
    assert rewrite(TEXT.replace("\n", "\r\n")).count("\r\n") == TEXT.count("\n") + 1
    broken = TEXT.replace("</launch>", "")
    assert rewrite(broken) == broken


@pytest.mark.parametrize("path", sorted(LIBRARY.rglob("*.launch*")), ids=lambda path: path.name)
def test_plans_stay_the_same(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    changed = rewrite(text)
    assert rewrite(changed) == changed
    plans = [
        load_plan(["/a.launch"], ["robot_base:=stage"], MemoryWorld({"/a.launch": each})) for each in (text, changed)
    ]
    assert [node.full_name for node in plans[0].nodes] == [node.full_name for node in plans[1].nodes]
    assert [found.message for found in plans[0].diagnostics] == [found.message for found in plans[1].diagnostics]


@pytest.mark.skipif(ROSLAUNCH is None, reason="roslaunch is not installed")
def test_roslaunch_shows_them(tmp_path: Path) -> None:
    path = tmp_path / "a.launch"
    path.write_text(rewrite(TEXT))
    assert ROSLAUNCH is not None
    done = subprocess.run(
        [ROSLAUNCH, "--ros-args", str(path)],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
        env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "ROS_HOME": str(tmp_path), "ROS_PACKAGE_PATH": ""},
    )
    assert 'plain: A plain one, in "quotes" & with <tags> and $ (arg nothing).' in done.stdout
    assert 'single (default "1"): Two lines, with `code`.' in done.stdout
    assert 'stale (default "2"): Something new.' in done.stdout
    assert 'silent (default "3"): undocumented' in done.stdout
