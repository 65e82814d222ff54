"""One launch file for `ros2 launch`: what each tag becomes, and what is named because it has no counterpart."""

from pathlib import Path

import pytest
from tests.tools.convert.ros2_launch import LaunchedNode2, Ros2LaunchReader

from ur.launchfile.world import MemoryWorld
from ur.source.diagnostic import UserError
from ur.tools.convert.run import Converted, convert_file

FILE = "/src/demo/launch/demo.launch"
PARAMETERS = "# speeds\nmax: 1.5 # m/s\nturn: {rate: 2}\n"


def convert(body: str, **files: str) -> Converted:
    world = MemoryWorld(
        {FILE: f"<launch>{body}</launch>", "/src/demo/params/a.yaml": PARAMETERS, **files}, {"demo": "/src/demo"}
    )
    return convert_file(FILE, world)


def start(body: str, arguments: dict[str, str] | None = None, **files: str) -> list[LaunchedNode2]:
    made = convert(body, **files)
    assert not made.findings
    texts = {FILE: made.text, **{each.path: each.text for each in made.files}}
    return Ros2LaunchReader(texts, {"demo": "/src/demo"}).read(FILE, arguments or {})


def test_node_keeps_names_arguments_and_options() -> None:
    (node,) = start(
        '<arg name="who" default="it"/>'
        '<group ns="robot"><node pkg="demo" type="talk" name="talker" ns="left" args="--to $(arg who)" output="screen"'
        ' respawn="true" respawn_delay="2" launch-prefix="nice"/></group>'
    )
    assert (node.name, node.package, node.program, node.args) == ("/robot/left/talker", "demo", "talk", ["--to", "it"])
    assert node.options == {"output": "screen", "respawn": "true", "respawn_delay": "2.0", "launch-prefix": "nice"}


def test_required_node_ends_the_launch() -> None:
    (node,) = start('<node pkg="demo" type="talk" name="a" required="true"/>')
    assert node.options == {"on_exit": "shutdown"}


def test_parameters_keep_their_types() -> None:
    (node,) = start(
        '<node pkg="demo" type="talk" name="a"><param name="code" type="str" value="007"/>'
        '<param name="on" value="true"/>'
        '<param name="a/b" value="3"/><param name="half" type="double" value="0.5"/><param name="text" value="yes"/>'
        '<param name="flag" type="bool" value="1"/></node>'
    )
    assert node.parameters == {
        "code": "007",
        "on": True,
        "a": {"b": 3},
        "half": 0.5,
        "text": "yes",
        "flag": True,
    }


def test_file_of_parameters_keeps_its_comments() -> None:
    body = '<node pkg="demo" type="talk" name="a"><rosparam file="$(find demo)/params/a.yaml"/></node>'
    (file,) = convert(body).files
    assert file.text.splitlines()[:3] == ["/**:", "  ros__parameters:", "    # speeds"]
    assert start(body)[0].parameters == {"max": 1.5, "turn": {"rate": 2}}


def test_every_file_that_an_argument_may_choose_is_converted() -> None:
    body = (
        '<arg name="base"/><node pkg="demo" type="talk" name="a">'
        '<rosparam file="$(find demo)/params/$(arg base).yaml" command="load"/></node>'
    )
    made = convert(body, **{"/src/demo/params/b.yaml": "angle: deg(180)\npoints: [{name: left, x: 1}]\n"})
    assert [each.path for each in made.files] == ["/src/demo/params/a.yaml", "/src/demo/params/b.yaml"]
    assert '"angle": 3.14159' in made.files[1].text
    assert '"left":\n' in made.files[1].text


def test_single_parameter_wins_over_file() -> None:
    (node,) = start(
        '<node pkg="demo" type="talk" name="a"><param name="max" value="2.5"/>'
        '<rosparam file="$(find demo)/params/a.yaml"/></node>'
    )
    assert node.parameters["max"] == 2.5


def test_included_file_gets_its_arguments_and_no_others() -> None:
    inner = (
        '<launch><arg name="speed" default="1"/><arg name="name"/><node pkg="demo" type="t" name="$(arg name)">'
        '<param name="speed" value="$(arg speed)"/></node></launch>'
    )
    files = {"/src/demo/launch/inner.launch": inner}
    outer = (
        '<arg name="speed" default="9"/><arg name="n" default="a"/>'
        '<include file="$(find demo)/launch/inner.launch" ns="x"><arg name="name" value="$(arg n)"/></include>'
        '<node pkg="demo" type="t" name="last"/>'
    )
    world = MemoryWorld({FILE: f"<launch>{outer}</launch>", **files}, {"demo": "/src/demo"})
    texts = {path: convert_file(path, world).text for path in (FILE, *files)}
    first, last = Ros2LaunchReader(texts, {"demo": "/src/demo"}).read(FILE, {})
    assert (first.name, first.parameters, last.name) == ("/x/a", {"speed": 1}, "/last")


def test_conditions_inside_a_node_become_a_node_for_each_case() -> None:
    body = (
        '<arg name="scan" default="scan"/><node pkg="demo" type="t" name="a">'
        '<remap from="scan" to="$(arg scan)" if="$(eval arg(\'scan\') != \'\')"/>'
        '<param name="blind" value="true" if="$(eval arg(\'scan\') == \'\')"/></node>'
    )
    assert [(each.remaps, each.parameters) for each in start(body)] == [([("scan", "scan")], {})]
    assert [(each.remaps, each.parameters) for each in start(body, {"scan": ""})] == [([], {"blind": True})]


def test_remap_and_variable_of_a_group_end_with_it() -> None:
    first, last = start(
        '<group><remap from="~a" to="b"/><env name="X" value="1"/><node pkg="demo" type="t" name="a"/></group>'
        '<node pkg="demo" type="t" name="b"><env name="Y" value="2"/></node>'
    )
    assert (first.remaps, first.environment) == ([("~/a", "b")], {"X": "1"})
    assert (last.remaps, last.environment) == ([], {"Y": "2"})


@pytest.mark.parametrize(
    ("expression", "arguments", "expected"),
    [
        ("arg('a') == 'x'", {"a": "x"}, "True"),
        ("'b' if not arg('a') else 'c'", {"a": "False"}, "b"),
        ("a and arg('b')", {"a": "true", "b": "1"}, "1"),
        ("min(2.5, arg('a'))", {"a": "2"}, "2"),
        ("int(arg('a')) or 640", {"a": "0"}, "640"),
        ("arg('a') != False", {"a": "devices"}, "True"),
        ("str(arg('a')) + '/x'", {"a": "y"}, "y/x"),
        ("2 * arg('a') + 1", {"a": "3"}, "7"),
        ("env('HOME') + '/a'", {}, "/home/user/a"),
        ("optenv('UR_NOT_SET', 'none').upper()", {}, "NONE"),
        ("find('demo') + '\\\\'", {}, "/src/demo\\"),
        ("'%s-%d' % ('a', 3)", {}, "a-3"),
        ("arg('a') in ['x', 'y']", {"a": "y"}, "True"),
        ("'it\\'s' if arg('a') > 1 else \"no\"", {"a": "2"}, "it's"),
    ],
)
def test_expression_has_the_same_value(
    monkeypatch: pytest.MonkeyPatch, expression: str, arguments: dict[str, str], expected: str
) -> None:
    monkeypatch.setenv("HOME", "/home/user")
    declared = "".join(f'<arg name="{name}"/>' for name in arguments)
    written = f"$(eval {expression})".replace('"', "&quot;").replace(">", "&gt;")
    (node,) = start(
        f'{declared}<node pkg="demo" type="t" name="a"><param name="p" type="str" value="{written}"/></node>', arguments
    )
    assert node.parameters["p"] == expected


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ('<param name="speed" value="1"/>', "the global parameter 'speed'"),
        ('<rosparam file="$(find demo)/params/a.yaml"/>', "<rosparam> outside of a <node>"),
        ('<test pkg="demo" type="t" test-name="a"/>', "<test> has no counterpart"),
        ('<machine name="far" address="far.local"/>', "ros2 launch starts nothing elsewhere"),
        ('<node pkg="demo" type="t" name="a" machine="far"/>', "a node has machine="),
        ('<node pkg="demo" type="t" name="a" cwd="node"/>', "cwd= names no folder"),
        ('<node pkg="tf" type="static_transform_publisher" name="a"/>', "package 'tf' is of ROS 1"),
        ('<arg name="r"/><node pkg="demo" type="t" name="a" required="$(arg r)"/>', "required= is computed"),
        (
            '<node pkg="demo" type="t" name="a"><rosparam command="delete" param="x"/></node>',
            '<rosparam command="delete">',
        ),
        ('<node pkg="demo" type="t" name="a"><rosparam file="$(find demo)/b.yaml"/></node>', "no file of parameters"),
        ('<node pkg="demo" type="t" name="a"><!--terminal: keys--></node>', "needs a terminal"),
        ('<arg name="a"/><arg name="b" default="$(eval arg(\'a\') + arg(\'a\'))"/>', "may be texts or numbers"),
        ('<param name="/use_sim_time" value="true"/>', "it holds for the nodes of this file only"),
        ('<arg name="b" default="$(eval [x for x in (1, 2)])"/>', "ListComp in an expression"),
        ('<node pkg="demo" type="t" name="a"><param name="p" binfile="/x"/></node>', "a binary parameter"),
    ],
)
def test_what_has_no_counterpart_is_named_with_its_place(body: str, said: str) -> None:
    (found,) = convert(body).findings
    assert said in found.message
    assert found.help
    assert found.span is not None or "no file" in said


def test_file_for_ros2_is_refused() -> None:
    with pytest.raises(UserError, match="launch file for ROS 2"):
        convert('<let name="a" value="1"/>')


def test_description_stands_in_the_nodes_that_publish_it(tmp_path: Path) -> None:
    urdf = tmp_path / "it's a robot.urdf"
    urdf.write_text("<robot/>")
    (node,) = start(
        f'<param name="robot_description" textfile="{urdf}"/>'
        '<node pkg="robot_state_publisher" type="robot_state_publisher" name="a"/>'
    )
    assert node.parameters == {"robot_description": "<robot/>"}


def test_program_prints_a_parameter() -> None:
    made = convert('<node pkg="demo" type="t" name="a"><param name="p" command="xacro \'a b\' x:=1"/></node>')
    assert """value="$(command &quot;xacro 'a b' x:=1&quot; 'warn')\"""" in made.text
