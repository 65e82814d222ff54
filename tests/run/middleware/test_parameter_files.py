"""Parameters of a launch file as ROS 2 reads them."""

import json
from typing import Any

from ur.launchfile.load import load_plan
from ur.launchfile.world.memory import MemoryWorld
from ur.run.middleware.parameter_files import file_name, format_parameters
from ur.run.middleware.ros2 import arguments_of


def read(body: str, printed: dict[str, Any] | None = None) -> dict[str, Any]:
    """The parameters of each node of a launch file, by its full name."""
    world = MemoryWorld({"/a.launch": f"<launch>{body}</launch>"})
    plan = load_plan(["/a.launch"], [], world)
    files = format_parameters(plan, printed or {})
    found = {name: json.loads(text) for name, text in files.items()}
    return {name: each["/**"]["ros__parameters"] if each else {} for name, each in found.items()}


def node(name: str, inside: str = "", kind: str = "t", **attributes: str) -> str:
    more = "".join(f' {key}="{value}"' for key, value in attributes.items())
    return f'<node name="{name}" pkg="p" type="{kind}"{more}>{inside}</node>'


def test_node_gets_its_own_parameters_as_a_tree() -> None:
    first = node("a", '<param name="x" value="1"/><param name="deep/y" value="2.5"/>')
    second = node("b", '<param name="x" value="text"/>', ns="room")
    assert read(first + second) == {"/a": {"x": 1, "deep": {"y": 2.5}}, "/room/b": {"x": "text"}}


def test_parameters_of_all_nodes_reach_those_that_ask_for_them() -> None:
    shared = '<param name="/use_sim_time" value="true"/><param name="/robot_description" value="[urdf]" type="str"/>'
    found = read(shared + node("a") + node("frames", kind="robot_state_publisher", ns="room"))
    assert found["/a"] == {"use_sim_time": True}
    assert found["/room/frames"] == {"use_sim_time": True, "robot_description": "[urdf]"}


def test_lists_become_what_ros2_can_hold() -> None:
    inside = """<rosparam>
sources: [{name: keys, priority: 90}, {name: stick, priority: 100}]
footprint: [[0.1, 0.2], [0.3, 0.4]]
numbers: [1, 2.5]
texts: [a, b]
nothing: []
mixed: [1, a]
</rosparam>"""
    assert read(node("a", inside))["/a"] == {
        "sources": {"keys": {"priority": 90}, "stick": {"priority": 100}},
        "footprint": "[[0.1, 0.2], [0.3, 0.4]]",
        "numbers": [1.0, 2.5],
        "texts": ["a", "b"],
        "mixed": ["1", "a"],
    }


def test_value_that_a_program_prints_is_the_parameter() -> None:
    found = read(node("a", '<param name="x" command="true"/>'), {"/a/x": "printed"})
    assert found == {"/a": {"x": "printed"}}


def test_arguments_name_the_node_and_its_topics_as_ros2_does() -> None:
    inside = '<remap from="~goal" to="/goal_pose"/>'
    world = MemoryWorld({"/a.launch": f"<launch>{node('a', inside, ns='room')}</launch>"})
    [spec] = load_plan(["/a.launch"], [], world).nodes
    file = file_name("/logs", spec.full_name)
    assert file == "/logs/room-a.parameters.yaml"
    assert " ".join(arguments_of(spec, file)) == (
        "--ros-args -r __node:=a -r __ns:=/room -r ~/goal:=/goal_pose --params-file /logs/room-a.parameters.yaml"
    )
