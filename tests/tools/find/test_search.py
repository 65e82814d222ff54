"""Definitions and uses over a workspace."""

import pytest

from ur.launchfile.world.memory import MemoryWorld
from ur.tools.find.search import find_name

TOP = """<launch>
  <arg name="robot_base"/>
  <arg name="topic" default="scan"/>
  <include file="$(find p)/part_$(arg robot_base).launch.xml">
    <arg name="topic" value="$(arg topic)"/>
  </include>
  <node name="eye" pkg="p" type="eye.py"><!--ready: topic picture 5 Hz-->
    <remap from="image" to="/camera/$(arg topic)"/>
    <rosparam command="load" file="$(find p)/params/$(arg robot_base).yaml"/>
  </node>
</launch>
"""
PART = """<launch>
  <arg name="topic"/>
  <group ns="front">
    <node name="watch_$(arg topic)" pkg="p" type="eye.py"/>
    <param name="gain" value="2"/>
  </group>
</launch>
"""
WORLD = MemoryWorld(
    {
        "/p/package.xml": "<package><name>p</name></package>",
        "/p/top.launch": TOP,
        "/p/part_one.launch.xml": PART,
        "/p/part_two.launch.xml": PART,
        "/p/params/one.yaml": "rate: 1\n",
        "/p/params/two.yaml": "rate: 2\n",
        "/p/bases/one/base.yaml": "summary: x\n",
        "/p/bases/two/base.yaml": "summary: y\n",
        "/p/bin/ur_top": "#!/bin/bash\nur launch p top.launch topic:=scan_2\n",
    },
    {"p": "/p"},
    executables=["/p/bin/ur_top"],
)


def places(name: str, *kinds: str) -> list[str]:
    found = find_name(name, ["/p"], WORLD, kinds or ("arg", "node", "topic", "param", "file"))  # type: ignore[arg-type]  # the tests write plain words
    return [f"{each.kind} {each.name} {'is' if each.defines else 'in'} {each.span}" for each in found]


def test_argument_is_found_where_it_is_declared_used_handed_on_and_given() -> None:
    assert places("topic", "arg") == [
        "arg topic is /p/part_one.launch.xml:2:14",
        "arg topic is /p/part_two.launch.xml:2:14",
        "arg topic is /p/top.launch:3:14",
        "arg topic in /p/bin/ur_top:2:24",
        "arg topic in /p/part_one.launch.xml:4:29",
        "arg topic in /p/part_two.launch.xml:4:29",
        "arg topic in /p/top.launch:5:16",
        "arg topic in /p/top.launch:5:36",
        "arg topic in /p/top.launch:8:43",
    ]


def test_node_is_found_under_the_name_it_gets_for_each_base() -> None:
    assert places("/front/watch_scan") == [
        "node /front/watch_scan is /p/part_one.launch.xml:4:5",
        "node /front/watch_scan is /p/part_two.launch.xml:4:5",
    ]
    assert places("watch_*", "node") == places("/front/watch_scan")


def test_parameters_of_tags_and_of_yaml_files_are_found() -> None:
    assert places("gain") == [
        "param /front/gain is /p/part_one.launch.xml:5:5",
        "param /front/gain is /p/part_two.launch.xml:5:5",
    ]
    assert {line.split(" is ")[0] for line in places("rate")} == {"param /eye/rate"}


def test_topics_are_found_in_remaps_and_in_what_a_node_waits_for() -> None:
    assert places("/camera/scan", "topic") == ["topic /camera/scan is /p/top.launch:8:5"]
    assert places("image", "topic") == ["topic image in /p/top.launch:8:5"]
    assert places("picture", "topic") == ["topic /picture in /p/top.launch:7:3"]


@pytest.mark.parametrize(
    ("name", "users"),
    [
        ("part_two.launch.xml", ["/p/top.launch:4:18"]),
        ("params/one.yaml", ["/p/top.launch:9:36"]),
        ("top.launch", []),
    ],
)
def test_file_is_found_where_it_is_included_or_loaded(name: str, users: list[str]) -> None:
    first, *others = places(name, "file")
    assert first == f"file /p/{name} is /p/{name}:1:1"
    assert [line.split(" in ")[1] for line in others] == users


def test_nothing_is_found_for_a_part_of_a_name() -> None:
    assert places("opic") == []


def test_arguments_and_nodes_of_launch_files_of_ros_2_are_found() -> None:
    text = '<launch><arg name="speed" default="1"/><node pkg="demo" exec="talker" name="talker"/></launch>'
    world = MemoryWorld({"/q/top.launch.xml": text})
    (argument,) = find_name("speed", ["/q"], world)
    assert (argument.kind, argument.defines, str(argument.span)) == ("arg", True, "/q/top.launch.xml:1:20")
    (node,) = find_name("talker", ["/q"], world, ("node",))
    assert (node.name, node.defines) == ("/talker", True)
