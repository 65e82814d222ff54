from collections.abc import Collection

from ur.request.plan_files import is_this_computer, selected_arguments, texts
from ur.robot.selection import Selection

ALL = ("robot_base", "robot_variant", "robot_machine", "viewer_machine", "simulate")


def select(
    selection: Selection, declared: Collection[str] = ALL, given: Collection[str] = (), *, local: bool
) -> list[str]:
    return texts(selected_arguments(selection, declared, given, local=local))


def test_simulated_robot_is_here() -> None:
    assert select(Selection("sim", "magni", "lidar"), local=True) == [
        "robot_base:=magni",
        "robot_variant:=lidar",
        "robot_machine:=localhost",
        "viewer_machine:=localhost",
    ]


def test_real_robot_is_not_simulated() -> None:
    assert "simulate:=false" in select(Selection("robbie", "magni", ""), local=True)


def test_what_is_given_or_not_declared_is_left_alone() -> None:
    selection = Selection("sim", "magni", "lidar")
    assert select(selection, ("robot_base", "robot_variant"), {"robot_base"}, local=True) == []
    assert select(selection, ("robot_variant",), local=True) == ["robot_variant:=lidar"]


def test_robot_that_is_another_computer_is_a_machine_of_its_name() -> None:
    selection = Selection("robbie", "", "")
    assert select(selection, local=False) == [
        "robot_machine:=robbie",
        "viewer_machine:=localhost",
        "simulate:=false",
    ]
    assert select(selection, ("viewer_machine",), local=False) == ["viewer_machine:=localhost"]


def test_no_computer_is_called_like_that() -> None:
    assert not is_this_computer("no-such-robot-anywhere")
