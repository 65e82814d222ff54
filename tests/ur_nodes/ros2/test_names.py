import pytest

from ur_nodes.ports.raw import UPSTREAM, ros1_name, upstream_name
from ur_nodes.ros2.names import arguments_of, full_name, name_of


@pytest.mark.parametrize(
    ("given", "expected"),
    [("scan", "scan"), ("/tf", "/tf"), ("~goal", "~/goal"), ("~/goal", "~/goal"), ("ns/scan", "ns/scan")],
)
def test_private_names_get_a_slash(given: str, expected: str) -> None:
    assert name_of(given) == expected


def test_full_name_has_one_slash_before_the_name() -> None:
    assert full_name("/", "mux") == "/mux"
    assert full_name("/robot", "mux") == "/robot/mux"


def test_command_line_of_a_launch_file_is_put_into_the_form_of_ros_2() -> None:
    given = ["__name:=mux", "__ns:=robot", "__log:=/tmp/x.log", "_rate:=10", "_gains/p:=1.5", "~scan:=/scan", "a:=b"]
    assert arguments_of(given) == [
        *("--ros-args", "-r", "__node:=mux", "-r", "__ns:=/robot", "-p", "rate:=10", "-p", "gains.p:=1.5"),
        *("-r", "~/scan:=/scan", "-r", "a:=b", "--"),
    ]


def test_arguments_of_the_program_itself_are_left_out() -> None:
    assert arguments_of(["map.yaml", "--verbose"]) == []


def test_arguments_in_the_form_of_ros_2_stay() -> None:
    assert arguments_of(["map.yaml", "--ros-args", "-r", "__node:=mux"]) == ["--ros-args", "-r", "__node:=mux"]


@pytest.mark.parametrize(
    ("full", "expected"),
    [
        ("/move_base/NavfnROS/plan", "/plan"),
        ("/robot1/move_base/global_costmap/costmap", "/robot1/global_costmap/costmap"),
        ("/move_base_simple/goal", "/goal_pose"),
        ("/move_base/hold", "/move_base/hold"),
        ("/my_move_base/goal", "/my_move_base/goal"),
        ("/scan", "/scan"),
    ],
)
def test_topics_of_navigation_have_the_names_of_nav2(full: str, expected: str) -> None:
    assert upstream_name(full) == expected


def test_names_of_ros_2_stay_as_they_are() -> None:
    assert [upstream_name(f"/{name}") for name in UPSTREAM.values()] == [f"/{name}" for name in UPSTREAM.values()]


def test_names_of_nav2_are_those_of_ros_1_again() -> None:
    names = [f"/robot1/{name}" for name in UPSTREAM]
    assert [ros1_name(upstream_name(name)) for name in names] == names
    assert ros1_name("/my_plan") == "/my_plan"
