"""Parameters have the values and types that launch_ros gives them, and come from the sections that rcl reads."""

from __future__ import annotations

import pytest
from tests.launchfile.ros2.plans import load, load_clean, parameters, python, rules, xml

TYPES = "from typing import List"
VALUES = [  # as written in a dict, the value
    ("1", 1),
    ("1.5", 1.5),
    ("True", True),
    ("'1'", "1"),
    ("'true'", "true"),
    ("''", ""),
    ("[1, 2]", [1, 2]),
    ("[1, 2.5]", [1.0, 2.5]),
    ("[True, False]", [True, False]),
    ("['a', 'b']", ["a", "b"]),
    ("['1', '2']", ["1", "2"]),
    ("('a', 'b')", ["a", "b"]),
    ("LaunchConfiguration('a')", 5),
    ("[LaunchConfiguration('a')]", 5),
    ("[LaunchConfiguration('a'), '0']", 50),
    ("[[LaunchConfiguration('a')], ['7']]", [5, 7]),
    ("['[', LaunchConfiguration('a'), ', 6]']", [5, 6]),
    ("TextSubstitution(text='no')", False),
    ("TextSubstitution(text='1e3')", "1e3"),
    ("TextSubstitution(text='')", ""),
    ("PathJoinSubstitution(['/a', 'b'])", "/a/b"),
    ("ParameterValue(LaunchConfiguration('a'), value_type=str)", "5"),
    ("ParameterValue(LaunchConfiguration('a'), value_type=float)", 5.0),
    ("ParameterValue(LaunchConfiguration('a'), value_type=int)", 5),
    ("ParameterValue(LaunchConfiguration('a'))", 5),
    ("ParameterValue('text')", "text"),
    ("ParameterValue(TextSubstitution(text='1'), value_type=bool)", True),
    ("ParameterValue(TextSubstitution(text='[1, 2]'), value_type=List[int])", [1, 2]),
    ("ParameterValue([[LaunchConfiguration('a')], ['b']], value_type=List[str])", ["5", "b"]),
    ("ParameterValue([1, 2.5])", [1.0, 2.5]),
    ("ParameterValue('7', value_type=str)", "7"),
    ("ParameterValue(TextSubstitution(text='a: b'), value_type=str)", "a: b"),
    ("ParameterValue(PythonExpression('1 < 2'), value_type=bool)", True),
]


@pytest.mark.parametrize(("text", "value"), VALUES)
def test_value_has_the_type_that_upstream_gives_it(text: str, value: object) -> None:
    actions = [
        "DeclareLaunchArgument('a', default_value='5')",
        f"Node(executable='n', name='n', parameters=[{{'p': {text}}}])",
    ]
    found = parameters(load_clean(python(*actions, before=TYPES)))["p"]
    assert (found, type(found)) == (value, type(value))
    if isinstance(value, list):
        assert isinstance(found, list)
        assert [type(each) for each in found] == [type(each) for each in value]


@pytest.mark.parametrize(
    "text",
    [
        "[]",
        "None",
        "[1, 'a', LaunchConfiguration('a')]",
        "TextSubstitution(text='a: b')",
        "TextSubstitution(text='[1, a]')",
        "TextSubstitution(text='[')",
        "ParameterValue(LaunchConfiguration('a'), value_type=bool)",
        "Path('/a')",
        "ParameterValue(Path('/a'))",
        "ParameterValue([1, 'a'])",
        "ParameterValue('a', value_type=int)",
        "ParameterValue(TextSubstitution(text='[1, a]'), value_type=list)",
    ],
)
def test_value_that_upstream_refuses_is_an_error(text: str) -> None:
    actions = [
        "DeclareLaunchArgument('a', default_value='5')",
        f"Node(executable='n', name='n', parameters=[{{'p': {text}}}])",
    ]
    plan = load(python(*actions, before="from pathlib import Path"))
    assert rules(plan) == ["bad-param-value"]
    assert plan.diagnostics[0].subject == "p"


def test_names_are_nested_and_may_be_substitutions() -> None:
    text = "{'a': {'b': 1, 'c': {'d': 2}}, LaunchConfiguration('a'): 3, ('x', LaunchConfiguration('a')): 4}"
    actions = ["DeclareLaunchArgument('a', default_value='n')", f"Node(executable='n', name='n', parameters=[{text}])"]
    assert parameters(load_clean(python(*actions))) == {"a.b": 1, "a.c.d": 2, "n": 3, "xn": 4}


def test_parameter_objects_and_later_sources_win() -> None:
    given = "'/p.yaml', {'a': 2, 'b': 2}, Parameter('b', 3)"
    plan = load_clean(
        python(
            f"Node(executable='n', name='n', parameters=[{given}])",
            before="from launch_ros.parameter_descriptions import Parameter",
        ),
        files={"/p.yaml": "n: {ros__parameters: {a: 1, c: 1}}"},
    )
    assert parameters(plan) == {"a": 2, "b": 3, "c": 1}


SECTIONS = [
    ("n: {ros__parameters: {a: 1}}", {"a": 1}),
    ("/ns/n: {ros__parameters: {a: 1}}", {"a": 1}),
    ("ns: {n: {ros__parameters: {a: 1}}}", {"a": 1}),
    ("/**: {ros__parameters: {a: 1}}", {"a": 1}),
    ("/**/n: {ros__parameters: {a: 1}}", {"a": 1}),
    ("/*/n: {ros__parameters: {a: 1}}", {"a": 1}),
    ("/*: {n: {ros__parameters: {a: 1}}}", {"a": 1}),
    ("/ns/*: {ros__parameters: {a: 1}}", {"a": 1}),
    ("/**: {ros__parameters: {a: 1}}\n/ns/n: {ros__parameters: {a: 2}}", {"a": 2}),
    ("/ns/n: {ros__parameters: {a: {b: 2}}}", {"a.b": 2}),
    ("m: {ros__parameters: {a: 1}}", {}),
    ("/other/n: {ros__parameters: {a: 1}}", {}),
    ("/*: {ros__parameters: {a: 1}}", {}),
    ("n: {a: 1}", {}),
    ("a: 1", {}),
    ("", {}),
]


@pytest.mark.parametrize(("text", "expected"), SECTIONS)
def test_section_of_a_file_is_for_the_nodes_that_it_names(text: str, expected: dict[str, object]) -> None:
    node = "Node(executable='n', name='n', namespace='ns', parameters=['/p.yaml'])"
    plan = load(python(node), files={"/p.yaml": text})
    assert rules(plan) == (["parameter-file"] if text and "ros__parameters" not in text else [])
    found = parameters(plan, "/ns/n")
    assert found == (expected if not text.startswith("n: {ros__") else {})


@pytest.mark.parametrize("text", ["a: [", "\tb: 1", "&a [*a]"])
def test_parameter_file_that_is_no_yaml_is_an_error(text: str) -> None:
    plan = load(python("Node(executable='n', name='n', parameters=['/p.yaml'])"), files={"/p.yaml": text})
    assert rules(plan) == ["bad-yaml"]


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ('<param name="a" value="1"/>', {"a": 1}),
        ('<param name="a" value="1.5"/>', {"a": 1.5}),
        ('<param name="a" value="true"/>', {"a": True}),
        ('<param name="a" value="text"/>', {"a": "text"}),
        ('<param name="a" value="\'1\'"/>', {"a": "1"}),
        ('<param name="a" value="1" type="str"/>', {"a": "1"}),
        ('<param name="a" value="1" type="float"/>', {"a": 1.0}),
        ('<param name="a" value="1, 2" value-sep=", "/>', {"a": [1, 2]}),
        ('<param name="a" value="1;2" value-sep=";" type="list_of_str"/>', {"a": ["1", "2"]}),
        ('<param name="a" value="1;2" value-sep=";" type="list_of_float"/>', {"a": [1.0, 2.0]}),
        ('<param name="a" value="[1, 2]" type="list_of_int"/>', {"a": [1, 2]}),
        ('<param name="a" value="1" type="bool"/>', {"a": True}),
        ('<param name="a" value="1.0" type="yaml"/>', {"a": 1.0}),
        ('<param name="a" value="\'[1, 2]\'"/>', {"a": "[1, 2]"}),
        ('<param name="a" value=""/>', {"a": ""}),
        ('<param name="a" value="[*]"/>', {"a": "[*]"}),
        ('<param name="a" value="[$(var v), 1]"/>', {"a": [5, 1]}),
        ('<param name="a" value="[x, y]"/>', {"a": ["x", "y"]}),
        ('<param name="a" value="$(var v)"/>', {"a": 5}),
        ('<param name="a" value="$(var v)" type="str"/>', {"a": "5"}),
        ('<param name="a"><param name="b" value="1"/></param>', {"a.b": 1}),
        ('<param name="$(var v)" value="x"/>', {"5": "x"}),
        ('<param from="$(find-pkg-share demo)/config/p.yaml"/>', {"rate": 5, "deep.inner": True}),
    ],
)
def test_parameter_of_xml_has_its_type(written: str, expected: dict[str, object]) -> None:
    body = f'<arg name="v" default="5"/><node pkg="" exec="n" name="n">{written}</node>'
    found = parameters(load_clean(xml(body), "/ws/a.launch.xml"))
    assert found == expected
    assert [type(each) for each in found.values()] == [type(each) for each in expected.values()]


@pytest.mark.parametrize(
    "written",
    [
        'value="[1, a]"',
        'value="a: b"',
        'value="x;$(var v)" value-sep=";"',
        'value="x" type="int"',
        'value="x" type="double"',
        'value="1" type="list_of_int"',
        'value="1.5" type="list_of_int"',
    ],
)
def test_parameter_of_xml_that_upstream_refuses_is_an_error(written: str) -> None:
    plan = load(
        xml(f'<arg name="v" default="5"/><node pkg="" exec="n"><param name="a" {written}/></node>'), "/a.launch.xml"
    )
    assert rules(plan) == ["bad-param-value"]


def test_parameters_of_yaml_keep_the_types_of_yaml() -> None:
    text = (
        "launch:\n- node:\n    pkg: ''\n    exec: n\n    name: n\n    param:\n    - {name: a, value: 1}\n"
        "    - {name: b, value: '1'}\n    - {name: c, value: [1, 2]}\n    - name: d\n"
        "      param: [{name: e, value: true}]\n"
    )
    assert parameters(load_clean(text, "/ws/a.launch.yaml")) == {"a": 1, "b": "1", "c": [1, 2], "d.e": True}


def test_sections_of_one_name_in_a_parameter_file_add_up() -> None:
    text = "/**:\n  ros__parameters: {a: 1, b: 1}\n/**:\n  ros__parameters: {b: 2}\nn: {ros__parameters: {c: 3}}\n"
    node = "Node(package='', executable='n', name='n', parameters=['/ws/p.yaml'])"
    assert parameters(load_clean(python(node), files={"/ws/p.yaml": text})) == {"a": 1, "b": 2, "c": 3}


@pytest.mark.parametrize(
    ("section", "rule"),
    [
        ("/robot1/talkr", ["parameter-section"]),
        ("/robot/talker", ["parameter-section"]),
        ("/robot1/map_saver", []),  # of one namespace, as all nodes of a robot
        ("/robot1/talker", []),
    ],
)
def test_section_is_near_a_node_by_its_last_name(section: str, rule: list[str]) -> None:
    node = "Node(package='', executable='n', name='talker', namespace='robot1', parameters=['/ws/p.yaml'])"
    files = {"/ws/p.yaml": f"{section}:\n  ros__parameters: {{a: 1}}\n"}
    assert rules(load(python(node), files=files)) == rule
