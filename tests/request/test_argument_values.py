from collections.abc import Sequence

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.memory import MemoryWorld
from ur.request.plan_files import blame_arguments
from ur.source.arguments import Argument, parse_argument

LIBRARY = """<launch>
  <arg name="x" default="0"/>
  <arg name="count" default="1"/>
  <param name="x" type="double" value="$(arg x)"/>
  <param name="again" type="double" value="$(arg x)"/>
  <param name="count" type="int" value="$(arg count)"/>
</launch>
"""
TOP = """<launch>
  <arg name="x" default="0"/>
  <arg name="number" default="1"/>
  <arg name="active" default="true"/>
  <include file="/library.launch" if="$(arg active)">
    <arg name="x" value="$(arg x)"/>
    <arg name="count" value="$(arg number)"/>
  </include>
</launch>
"""


def report(*argv: str, library: str = LIBRARY) -> list[str]:
    world = MemoryWorld(files={"/top.launch": TOP, "/library.launch": library})
    given = [argument for text in argv if (argument := parse_argument(text))]

    def replan(arguments: Sequence[Argument]) -> Plan:
        return load_plan(["/top.launch"], [str(each) for each in arguments], world)

    found = blame_arguments(replan(given).diagnostics, given, replan)
    return [f"{each.message}; {each.help}" if each.help else each.message for each in found]


def test_value_of_an_argument_is_reported_once_about_the_argument() -> None:
    assert report("x:=abc") == ["argument 'x' is 'abc', expected a number"]


def test_argument_that_is_passed_on_under_another_name_is_found() -> None:
    assert report("number:=1.5") == ["argument 'number' is '1.5', expected a whole number"]


@pytest.mark.parametrize(("value", "near"), [("yes", "true"), ("Off", "false"), ("flase", "false")])
def test_word_for_a_truth_value_is_suggested(value: str, near: str) -> None:
    assert report(f"active:={value}") == [
        f"argument 'active' is '{value}', expected true or false; did you mean active:={near}?"
    ]


def test_each_of_several_wrong_arguments_is_reported() -> None:
    assert len(report("x:=abc", "active:=maybe", "number:=two")) == 3


def test_error_of_the_library_itself_is_about_no_argument() -> None:
    assert report("x:=2", library=LIBRARY.replace("$(arg count)", "one")) == []
