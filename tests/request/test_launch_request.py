from collections.abc import Mapping, Sequence

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.world import MemoryWorld
from ur.request.launch_request import LaunchFiles, LaunchRequest, make_request
from ur.source import UserError
from ur.source.arguments import Argument, split_argv

FILES = {
    "/x.launch": '<launch><arg name="a"/><arg name="b" default=""/><arg name="c" value="1"/></launch>',
    "/top.launch": '<launch><include file="/x.launch"><arg name="a" value="1"/></include></launch>',
}


def test_declared_arguments_are_those_that_can_be_given() -> None:
    assert LaunchFiles(["/x.launch", "/none.launch"], MemoryWorld(files=FILES)).declared == ("a", "b")


def test_names_and_arguments_may_stand_in_any_order() -> None:
    request = make_request(split_argv(["a:=1", "/x.launch", "b:=x:=y"]), MemoryWorld(files=FILES))
    assert request.files.paths == ("/x.launch",)
    assert request.arguments == (Argument("a", "1"), Argument("b", "x:=y"))
    assert request.argv == ("/x.launch", "a:=1", "b:=x:=y")


def test_of_an_argument_that_is_given_twice_the_last_counts() -> None:
    request = make_request(split_argv(["/x.launch", "a:=1", "a:=2"]), MemoryWorld(files=FILES))
    assert request.values == {"a": "2"}
    assert request.add_arguments([Argument("a", "3")]).values == {"a": "3"}
    assert request.values == {"a": "2"}


def test_stray_name_is_explained() -> None:
    world = MemoryWorld(files=FILES)
    names = ("/x.launch", "/top.launch", "-")
    assert make_request(split_argv(names), world).files.paths == names
    with pytest.raises(UserError, match="'--aa=1' is not an argument, expected NAME:=VALUE with NAME one of a, b"):
        make_request(split_argv(["/x.launch", "--aa=1"]), world)


def test_each_file_is_parsed_once_for_all_plans_of_a_request() -> None:
    reads: list[str] = []

    class CountedWorld(MemoryWorld):
        def read_bytes(self, path: str) -> bytes:
            reads.append(path)
            return super().read_bytes(path)

    request: LaunchRequest = make_request(split_argv(["/top.launch", "/x.launch", "a:=1"]), CountedWorld(files=FILES))
    files = request.files
    assert files.declared == ("a", "b")
    for text in ("a:=1", "a:=2"):
        assert load_plan(files.paths, [text], files.world, parsed=files.parsed).diagnostics == ()
    assert sorted(each for each in reads if each.endswith(".launch")) == ["/top.launch", "/x.launch"]
    known = dict(files.parsed)
    assert files.parse("/x.launch") is known["/x.launch"]


ROS2 = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('a'),
        Node(executable=LaunchConfiguration('a'), arguments=[Command('describe robot')]),
        IncludeLaunchDescription('/b.launch.py', launch_arguments={'c': '1'}.items()),
    ])
"""
INNER = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
def generate_launch_description():
    return LaunchDescription([DeclareLaunchArgument(each, default_value='0') for each in ('b', 'c')])
"""


def test_file_for_ros2_is_read_and_its_commands_run_once_for_arguments_and_plan() -> None:
    reads: list[str] = []
    runs: list[tuple[str, ...]] = []

    class CountedWorld(MemoryWorld):
        def read_bytes(self, path: str) -> bytes:
            reads.append(path)
            return super().read_bytes(path)

    def run(words: Sequence[str], _: Mapping[str, str]) -> tuple[int, bytes, bytes]:
        runs.append(tuple(words))
        return 0, b"<robot/>", b""

    world = CountedWorld(files={"/a.launch.py": ROS2, "/b.launch.py": INNER})
    files = make_request(split_argv(["/a.launch.py", "a:=x", "b:=y"]), world, run=run).files
    assert files.declared == ("a", "b")
    plan = files.load(["a:=x", "b:=y"])
    assert [(node.type, node.words) for node in plan.nodes] == [("x", ("<robot/>",))]
    assert (sorted(reads), runs) == (["/a.launch.py", "/b.launch.py"], [("describe", "robot")])
    assert files.load(["a:=z"]).nodes[0].type == "z"
