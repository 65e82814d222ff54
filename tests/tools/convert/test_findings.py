"""Findings: what is named with its place and help, and what is converted beside it."""

import pytest
from tests.tools.convert.ros2_launch import Ros2LaunchReader
from tests.tools.convert.test_run import FILE, convert, start

from ur.launchfile.world import MemoryWorld
from ur.source.diagnostic import UserError
from ur.tools.convert.run import convert_file

NODE = '<node pkg="demo" type="t" name="a">'
FOUR = "".join(f'<param name="p" value="{each}" if="$(eval arg(\'a\') == \'{each}\')"/>' for each in range(4))


@pytest.mark.parametrize(
    ("body", "named", "message", "help_"),
    [
        ("<speed/>", "<speed/>", "<speed> has no counterpart in ROS 2", "remove it"),
        (
            '<arg name="a" if="$(eval load(1))"/>',
            "$(eval load(1))",
            "the function 'load' in an expression cannot be converted",
            "compute it outside of the launch file",
        ),
        (
            f'<arg name="i"/>{NODE}</node><include file="x"><arg name="y" value="1" if="$(arg i)"/></include>',
            '<arg name="y"',
            "a condition on an argument that is passed",
            "write an <include> for each case, and convert again",
        ),
        (
            '<arg name="i"/><remap from="a" to="$(arg i)"/><include file="x"/>',
            "<include",
            "a remap or variable with an argument holds for an included file",
            "pass the name as an argument to the included file, and remap it there",
        ),
        (
            '<param name="robot_description" value="x"/>',
            "<param",
            "the global parameter 'robot_description' (ROS 2 has no global ones) cannot be converted",
            "move it into each <node> that reads it",
        ),
        (
            f'<arg name="a"/>{NODE}{FOUR}</node>',
            "<node",
            "4 different conditions inside a <node>",
            "write a <node> for each case, and convert again",
        ),
        (
            '<arg name="a"/><node pkg="demo" type="t" name="a" respawn_delay="$(arg a)"/>',
            '$(arg a)"/>',
            "respawn_delay is computed, expected a number for ros2 launch",
            "write a number",
        ),
        (
            '<node pkg="demo" type="t" name="a" respawn_delay="soon"/>',
            "soon",
            "respawn_delay is 'soon', expected a number for ros2 launch",
            "write a number",
        ),
        (
            f'{NODE}<rosparam file="$(find demo)/params/a.yaml" ns="x"/></node>',
            "<rosparam",
            "a file of parameters below a name cannot be converted",
            "write the name into the file",
        ),
        (
            f"{NODE}<rosparam>[1, 2]</rosparam></node>",
            "<rosparam",
            "a value without a name cannot be converted",
            'add param="NAME"',
        ),
        (
            f'{NODE}<rosparam param="$(anon x)">1</rosparam></node>',
            "<rosparam",
            "a name that is computed cannot be converted",
            "write the names of the parameters",
        ),
        (
            f'{NODE}<param name="p" type="bool" value="perhaps"/></node>',
            "<param",
            "the value 'perhaps' (expected true, false, 1 or 0) cannot be converted",
            "ur check explains it",
        ),
        (
            f'{NODE}<param name="p" value="$(arg a b)"/></node>',
            "<param",
            "$(arg a b) cannot be converted",
            "ur check explains it",
        ),
        (
            f'{NODE}<param name="p" value="$(arg $(arg a))"/></node>',
            "<param",
            "'$' inside $(...), expected plain text: substitutions do not nest cannot be converted",
            "compute the inner part in an <arg value=...> of its own, or use $(eval ...)",
        ),
    ],
)
def test_finding_names_the_place_and_the_edit(body: str, named: str, message: str, help_: str) -> None:
    (found,) = convert(body).findings
    assert (found.message, found.help) == (message, help_)
    assert found.span is not None
    assert found.span.file.text[found.span.start :].startswith(named)


def test_values_that_are_not_yaml_are_named_with_the_reason_of_the_reader() -> None:
    (found,) = convert(f'{NODE}<param name="p" type="yaml" value="[1, 2"/><param name="q" value="1"/></node>').findings
    assert "expected ',' or ']'" in found.message
    assert found.help == "ur check explains it"


def test_yaml_value_becomes_parameters_by_their_names() -> None:
    (node,) = start(
        f'{NODE}<param name="p" type="yaml" value="{{a: 1, b: [x, y]}}"/>'
        '<rosparam ns="n" param="m">{c: 2}</rosparam></node>'
    )
    assert node.parameters == {"p": {"a": 1, "b": ["x", "y"]}, "n": {"m": {"c": 2}}}


def test_description_of_an_argument_is_its_doc_or_the_comment_after_it() -> None:
    text = convert('<arg name="a" doc="A thing."/><arg name="b"/><!--b: Another\n one.-->').text
    assert '<arg name="a" description="A thing."/>' in text
    assert '<arg name="b" description="Another one."/>' in text


def test_private_parameter_holds_for_later_nodes_only() -> None:
    first, last = start(f'{NODE}</node><param name="~rate" value="2"/><node pkg="demo" type="t" name="b"/>')
    assert (first.parameters, last.parameters) == ({}, {"rate": 2})


def test_parameter_of_a_node_has_a_condition_beside_the_condition_of_the_node() -> None:
    body = (
        '<arg name="on"/><arg name="fast"/><node pkg="demo" type="t" name="a" if="$(arg on)">'
        '<param name="rate" value="9" if="$(arg fast)"/></node>'
    )
    assert start(body, {"on": "false", "fast": "true"}) == []
    assert [each.parameters for each in start(body, {"on": "true", "fast": "true"})] == [{"rate": 9}]
    assert [each.parameters for each in start(body, {"on": "true", "fast": "false"})] == [{}]


def test_included_file_may_be_named_by_an_argument_and_gets_variables() -> None:
    declared = '<arg name="which" default="none"/>'
    inner = f'<launch>{declared}{NODE}<param name="who" type="str" value="$(arg which)"/></node></launch>'
    outer = (
        '<launch><arg name="which"/>'
        '<include file="$(dirname)/$(arg which).launch"><env name="KEY" value="1"/></include>'
        '<node pkg="demo" type="t" name="last"/></launch>'
    )
    files = {FILE: outer, "/src/demo/launch/inner.launch": inner}
    world = MemoryWorld(files, {"demo": "/src/demo"})
    texts = {path: convert_file(path, world).text for path in files}
    first, last = Ros2LaunchReader(texts, {"demo": "/src/demo"}).read(FILE, {"which": "inner"})
    assert (first.parameters, first.environment) == ({"who": "none"}, {"KEY": "1"})
    assert (last.name, last.environment) == ("/last", {})


def test_variables_of_the_environment_keep_their_defaults(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("UR_SIDE", "left")
    monkeypatch.delenv("UR_NOT_SET", raising=False)
    (node,) = start(
        f'{NODE}<param name="p" value="$(env UR_SIDE) $(optenv UR_NOT_SET it is)$(optenv UR_NOT_SET)"/></node>'
    )
    assert node.parameters == {"p": "left it is"}


def test_anonymous_name_stays_one() -> None:
    assert 'name="$(anon eye)"' in convert('<node pkg="demo" type="t" name="$(anon eye)"/>').text


@pytest.mark.parametrize(
    ("file", "message"),
    [
        ("rel/x.yaml", f"{FILE}: no file of parameters found for rel/x.yaml, expected one to convert"),
        ("$(find far)/x.yaml", f"{FILE}: no file of parameters found for $(find far)/x.yaml, expected one to convert"),
        ("/p/list.yaml", "/p/list.yaml: expected names with values, expected parameters"),
    ],
)
def test_parameter_file_that_is_not_converted_is_named(file: str, message: str) -> None:
    (found,) = convert(f'{NODE}<rosparam file="{file}"/></node>', **{"/p/list.yaml": "- 1\n"}).findings
    assert found.message == message
    assert found.help


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (None, "no such file or directory, expected a launch file"),
        ("<launch><node></launch>", "</launch>"),
        ("<robot/>", "<launch>"),
    ],
)
def test_file_that_is_no_launch_file_is_refused(text: str | None, reason: str) -> None:
    with pytest.raises(UserError) as problem:
        convert_file(FILE, MemoryWorld({} if text is None else {FILE: text}))
    assert reason in str(problem.value)


def test_numbers_that_are_not_finite_stay_numbers_in_inline_parameters() -> None:
    text = convert(f"{NODE}<rosparam>{{reach: .inf, least: -.inf, both: [1.0, .nan]}}</rosparam></node>").text
    assert '<param name="reach" value=".inf" type="float"/>' in text
    assert '<param name="least" value="-.inf" type="float"/>' in text
    assert '<param name="both" value="[1.0, .nan]"/>' in text
