"""The order of arguments, and when it stays as it is."""

import re
from pathlib import Path

import pytest
from tests.tools.format.test_layout import expect, format_text

from ur.check.collect import collect_targets
from ur.check.worlds import CachedWorld, make_world
from ur.tools.format.run import format_file


def names(text: str) -> list[str]:
    return re.findall(r'<arg name="(\w+)"', text)


def test_arguments_follow_summary_and_overview_by_kind_with_their_documentation() -> None:
    expect(
        """
        <launch>
          <arg name="c" default="1"/>
          <!--c: the last-->
          <!-- why b is needed -->
          <arg name="b" value="2"/><!--b: the second-->
          <node name="n" pkg="p" type="t"/>
          <arg name="a"/>
          <!--a: the first-->
          <!--Overview: Two.-->
          <!--Summary: One.-->
        </launch>
        """,
        """
        <launch>
          <!--Summary: One.-->
          <!--Overview: Two.-->

          <arg name="a"/>
          <!--a: the first-->

          <!-- why b is needed -->
          <arg name="b" value="2"/>
          <!--b: the second-->

          <arg name="c" default="1"/>
          <!--c: the last-->

          <node name="n" pkg="p" type="t"/>
        </launch>
        """,
    )


def test_titles_of_groups_are_written_anew() -> None:
    expect(
        """
        <launch>
          <!-- Optional args -->
          <arg name="b" default="1"/>
          <arg name="a"/>
          <param name="c" value="1"/>
        </launch>
        """,
        """
        <launch>
          <!-- Required arguments -->
          <arg name="a"/>

          <!-- Optional arguments -->
          <arg name="b" default="1"/>

          <param name="c" value="1"/>
        </launch>
        """,
    )


def test_argument_computed_from_an_optional_one_stays_behind_it() -> None:
    text = '<launch><arg name="a" default="1"/><arg name="b" value="$(arg a)"/><arg name="c" value="2"/></launch>'
    assert names(format_text(text).text) == ["c", "a", "b"]
    text = '<launch><arg name="a" default="1"/><arg name="b" value="$(eval a + 1)"/><arg name="c"/></launch>'
    assert names(format_text(text).text) == ["c", "a", "b"]


@pytest.mark.parametrize(
    "text",
    [
        # an error, which stays one
        '<launch><arg name="b" default="$(arg a)"/><arg name="a" value="1"/></launch>',
        '<launch><arg name="b" default="1"/><include file="/p/x.launch" pass_all_args="true"/><arg name="a"/></launch>',
    ],
)
def test_order_stays_where_another_would_mean_something_else(text: str) -> None:
    done = format_text(text, **{"x.launch": '<launch><arg name="a" default="7"/></launch>'})
    assert names(done.text)[:2] == ["b", "a"]
    assert done.kept is not None
    assert "the order of its arguments stays" in done.kept


def test_file_that_takes_in_its_own_text_is_left_alone() -> None:
    text = '<launch>\n      <param name="me" textfile="/p/launch/a.launch"/>\n</launch>\n'
    done = format_text(text)
    assert (done.text, done.changed) == (text, False)
    assert done.kept is not None


def test_plans_are_compared_for_each_base(tmp_path: Path) -> None:
    """An order that matters for one base only: its include sets what the argument's default reads."""
    for name in ("one", "two"):
        (tmp_path / "bases" / name).mkdir(parents=True)
        (tmp_path / "bases" / name / "base.yaml").write_text("summary: x\n")
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    text = """<launch>
  <arg name="robot_base"/>
  <group if="$(eval arg('robot_base') == 'two')">
    <arg name="a" value="1"/>
  </group>
  <arg name="a" default="2"/>
  <param name="a" value="$(arg a)"/>
</launch>
"""
    path = tmp_path / "a.launch"
    path.write_text(text)
    world = CachedWorld(make_world([str(path)], {"ROS_PACKAGE_PATH": ""}))
    package = collect_targets([str(path)], world).package_of(str(path))
    assert package is not None
    assert len(package.bases) == 2
    done = format_file(str(path), text.encode(), world, package)
    lines = done.text.splitlines()
    group = next(n for n, line in enumerate(lines) if "<group" in line)
    default = next(n for n, line in enumerate(lines) if "default" in line)
    assert (group < default) == (done.kept is not None)
