from __future__ import annotations

import pytest

from ur.launchfile.world import MemoryWorld
from ur.request.plan_files import declared_arguments, is_this_computer, refuse_stray_words, selected_arguments
from ur.robot.selection import Selection
from ur.source import UserError

ALL = ("robot_base", "robot_variant", "robot_machine", "viewer_machine", "simulate")


def test_simulated_robot_is_here() -> None:
    assert selected_arguments(Selection("sim", "magni", "lidar"), ALL, [], here=True) == [
        "robot_base:=magni",
        "robot_variant:=lidar",
        "robot_machine:=localhost",
        "viewer_machine:=localhost",
    ]


def test_real_robot_is_not_simulated() -> None:
    found = selected_arguments(Selection("robbie", "magni", ""), ALL, [], here=True)
    assert "simulate:=false" in found


def test_what_is_given_or_not_declared_is_left_alone() -> None:
    selection = Selection("sim", "magni", "lidar")
    assert selected_arguments(selection, ("robot_base", "robot_variant"), ["robot_base:=stage"], here=True) == []
    assert selected_arguments(selection, ("robot_variant",), [], here=True) == ["robot_variant:=lidar"]


def test_robot_that_is_another_computer_is_a_machine_of_its_name() -> None:
    selection = Selection("robbie", "", "")
    assert selected_arguments(selection, ALL, [], here=False) == [
        "robot_machine:=robbie",
        "viewer_machine:=localhost",
        "simulate:=false",
    ]
    assert selected_arguments(selection, ("viewer_machine",), [], here=False) == ["viewer_machine:=localhost"]


def test_declared_arguments_are_those_that_can_be_given() -> None:
    text = '<launch><arg name="a"/><arg name="b" default=""/><arg name="c" value="1"/></launch>'
    world = MemoryWorld(files={"/x.launch": text})
    assert declared_arguments(["/x.launch", "/none.launch"], world) == ("a", "b")


def test_stray_word_is_explained() -> None:
    world = MemoryWorld(files={"/x.launch": "<launch/>"})
    refuse_stray_words(["/x.launch", "/x.launch", "-"], ("world",), world)
    with pytest.raises(UserError, match="'--wrld=office' is no argument, expected NAME:=VALUE with NAME one of world"):
        refuse_stray_words(["/x.launch", "--wrld=office"], ("world",), world)


def test_no_computer_is_called_like_that() -> None:
    assert not is_this_computer("no-such-robot-anywhere")
