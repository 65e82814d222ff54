"""Launch files of ROS 2 in Python as XML and YAML: what each action becomes, and what is refused with its line."""

import textwrap

import pytest

from ur.launchfile.world import MemoryWorld
from ur.tools.convert.other_language import convert_to, name_in
from ur.tools.convert.run import Converted

FILE = "/src/demo/launch/demo.launch.py"
IMPORTS = """
import os
from pathlib import Path
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.events import Shutdown as ShutdownEvent
from launch.launch_description_sources import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.descriptions import *
from launch_ros.substitutions import *
"""
FILES = {
    "/opt/demo/share/demo/config/a.yaml": "talker:\n  ros__parameters: {rate: 2}\n",
    "/opt/demo/share/demo/urdf/robot.urdf": "<robot name='r'>" + " " * 60 + "</robot>",
    "/opt/demo/share/demo/launch/inner.launch.py": "from launch import LaunchDescription\n"
    "from launch.actions import *\n"
    "def generate_launch_description():\n"
    "    return LaunchDescription([DeclareLaunchArgument('mode', default_value='a')])\n",
    "/src/demo/launch/own.yaml": "/**:\n  ros__parameters: {own: 1}\n",
}


def convert(body: str, before: str = "", language: str = "xml", **environment: str) -> Converted:
    text = f"{IMPORTS}\ndef generate_launch_description():\n{textwrap.indent(textwrap.dedent(before), '    ')}\n"
    text += f"    return LaunchDescription([\n{body}\n    ])\n"
    packages = {"demo": "/opt/demo/share/demo", "other": "/opt/demo/share/other"}
    return convert_to(FILE, MemoryWorld({**FILES, FILE: text}, packages, environment), language)  # type: ignore[arg-type]


def lines(body: str, before: str = "", language: str = "xml", **environment: str) -> str:
    made = convert(body, before, language, **environment)
    assert not made.findings, [(each.message, each.notes) for each in made.findings]
    text = " ".join(made.text.split())
    return text.removeprefix("<?xml version='1.0'?> <launch> ").removesuffix(" </launch>").replace("&quot;", '"')


CASES = {
    "argument": (
        "DeclareLaunchArgument('m', default_value='a', description='$(x)', choices=['a', 'b'])",
        '<arg name="m" default="a" description="\\$(x)"> <choice value="a"/> <choice value="b"/> </arg>',
    ),
    "path of a package": (
        "DeclareLaunchArgument('f', default_value=os.path.join(get_package_share_directory('demo'), 'config/a.yaml'))",
        '<arg name="f" default="$(find-pkg-share demo)/config/a.yaml"/>',
    ),
    "joined path": (
        "DeclareLaunchArgument('f', default_value=PathJoinSubstitution([FindPackageShare('demo'), 'a', 'b.yaml']))",
        '<arg name="f" default="$(find-pkg-share demo)/a/b.yaml"/>',
    ),
    "path beside the file": (
        "DeclareLaunchArgument('f', default_value=str(Path(__file__).parent / 'own.yaml'))",
        '<arg name="f" default="$(dirname)/own.yaml"/>',
    ),
    "variable": (
        "DeclareLaunchArgument('v', default_value='x_' + os.environ['MODEL'] + os.environ.get('MORE', ''))",
        '<arg name="v" default="x_$(env MODEL)$(env MORE \'\')"/>',
    ),
    "conditions": (
        "DeclareLaunchArgument('m', default_value='true'),"
        "Node(package='p', executable='a', condition=UnlessCondition(LaunchConfiguration('m'))),"
        "Node(package='p', executable='b', condition=LaunchConfigurationEquals('m', 'x')),"
        "Node(package='p', executable='c', condition=IfCondition(PythonExpression(["
        "\"'\", LaunchConfiguration('m'), \"' == 'true'\"])))",
        '<arg name="m" default="true"/> <node pkg="p" exec="a" unless="$(var m)"/>'
        ' <node pkg="p" exec="b" if="$(equals $(var m) x)"/>'
        ' <node pkg="p" exec="c" if="$(eval "\'$(var m)\' == \'true\'")"/>',
    ),
    "node": (
        "Node(package='p', executable='e', name='n', namespace='s', output='screen', respawn=True, respawn_delay=2.0,"
        " arguments=['-a', 'two words', ['b:=', EnvironmentVariable('HOME')]], remappings=[('x', 'y')],"
        " ros_arguments=['--log-level', 'info'], additional_env={'A': 'b'}, on_exit=Shutdown())",
        '<node name="n" pkg="p" exec="e" namespace="s" args="-a \'two words\' b:=$(env HOME)"'
        ' ros_args="--log-level info" output="screen" respawn="true" respawn_delay="2.0" on_exit="shutdown">'
        ' <remap from="x" to="y"/>'
        ' <env name="A" value="b"/> </node>',
    ),
    "parameters": (
        "Node(package='p', executable='e', name='talker', parameters=["
        "{'i': 1, 'f': 1e-5, 't': '007', 's': 'plain', 'on': False, 'a': {'b': 2}, 'l': [1.0, 2], 'w': ['x', 'y z']},"
        "os.path.join(get_package_share_directory('demo'), 'config/a.yaml'),"
        "{'c': ParameterValue(Command(['echo ', 'x']), value_type=str)},"
        "ParameterFile(str(Path(__file__).parent / 'own.yaml'), allow_substs=True)])",
        '<node name="talker" pkg="p" exec="e"> <param name="i" value="1"/> <param name="f" value="1e-05" type="float"/>'
        ' <param name="t" value="007" type="str"/> <param name="s" value="plain"/> <param name="on" value="false"/>'
        ' <param name="a.b" value="2"/> <param name="l" value="[1.0, 2.0]"/> <param name="w" value="[x, y z]"/>'
        ' <param from="$(find-pkg-share demo)/config/a.yaml"/>'
        ' <param name="c" value="$(command \'echo x\')" type="str"/>'
        ' <param from="$(dirname)/own.yaml" allow_substs="true"/> </node>',
    ),
    "group": (
        "GroupAction([PushRosNamespace('s'), SetRemap('/tf', 'tf'), SetParameter('use_sim_time', True),"
        " Node(package='p', executable='e')], scoped=True)",
        '<group scoped="true"> <push_ros_namespace namespace="s"/> <set_remap from="/tf" to="tf"/>'
        ' <set_parameter name="use_sim_time" value="true"/> <node pkg="p" exec="e"/> </group>',
    ),
    "include": (
        "IncludeLaunchDescription(PythonLaunchDescriptionSource([FindPackageShare('demo'), '/launch/inner.launch.py']),"
        " launch_arguments={'mode': 'b'}.items())",
        '<include file="$(find-pkg-share demo)/launch/inner.launch.py"> <arg name="mode" value="b"/> </include>',
    ),
    "components": (
        "ComposableNodeContainer(package='rclcpp_components', executable='component_container', name='c', namespace='',"
        " composable_node_descriptions=[ComposableNode(package='p', plugin='p::T', name='t',"
        " parameters=[{'a': 1}], extra_arguments=[{'use_intra_process_comms': True}])])",
        '<node_container name="c" pkg="rclcpp_components" exec="component_container" namespace="">'
        ' <composable_node name="t" pkg="p" plugin="p::T"> <param name="a" value="1"/>'
        ' <extra_arg name="use_intra_process_comms" value="true"/> </composable_node> </node_container>',
    ),
    "timer": (
        "TimerAction(period=2.5, actions=[ExecuteProcess(cmd=['echo', 'a b'], output='screen')])",
        '<timer period="2.5"> <executable cmd="echo \'a b\'" output="screen"/> </timer>',
    ),
    "nested quotation marks": (
        "SetLaunchConfiguration('x', Command(['xacro a.xacro ns:=', PythonExpression(['1', ' + ', '1'])]))",
        '<let name="value_1" value="$(eval \'1 + 1\')"/>'
        ' <let name="x" value="$(command \'xacro a.xacro ns:=$(var value_1)\')"/>',
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_python_becomes_xml(name: str) -> None:
    body, expected = CASES[name]
    assert lines(body, MODEL="m") == expected


@pytest.mark.parametrize("name", CASES)
def test_python_becomes_yaml_with_the_same_plan(name: str) -> None:
    assert not convert(CASES[name][0], language="yaml", MODEL="m").findings


def test_yaml_keeps_the_types_of_parameters() -> None:
    text = convert(CASES["parameters"][0], language="yaml").text
    assert "- name: t\n      value: '007'\n" in text
    assert "- name: l\n      value:\n      - 1.0\n      - 2.0\n" in text
    assert "- name: 'on'\n      value: false\n" in text


def test_read_file_becomes_its_content() -> None:
    before = "text = open(get_package_share_directory('demo') + '/urdf/robot.urdf').read()"
    made = lines("Node(package='p', executable='e', parameters=[{'robot_description': text}])", before)
    assert 'value="$(file-content $(find-pkg-share demo)/urdf/robot.urdf)" type="str"' in made


def test_variable_that_the_file_sets_is_set_before_all_else() -> None:
    made = lines("Node(package='p', executable='e')", "os.environ['LEVEL'] = 'high'")
    assert made == '<set_env name="LEVEL" value="high"/> <node pkg="p" exec="e"/>'


REFUSED = {
    "RegisterEventHandler(OnProcessExit(target_action=Node(package='p', executable='e'), on_exit=[]))": (
        "RegisterEventHandler cannot be converted"
    ),
    "OpaqueFunction(function=lambda context: [])": "OpaqueFunction cannot be converted",
    "LoadComposableNodes(target_container='c', composable_node_descriptions=["
    "ComposableNode(package='p', plugin='p::T')])": "ComposableNode without name cannot be converted",
    "Node(package='p', executable='e', env={'A': 'b'})": "env= of Node cannot be converted",
    "Node(package='p', node_executable='e')": "'node_executable' was removed from Node",
}


@pytest.mark.parametrize("body", REFUSED)
def test_what_has_no_counterpart_is_named_with_its_line(body: str) -> None:
    found = convert(body).findings[0]
    assert REFUSED[body] in found.message
    assert found.span is not None
    assert found.span.position.line == 19


def test_variable_that_decides_is_named() -> None:
    (found,) = convert("Node(package='p', executable='e' if os.environ.get('D', '') == 'x' else 'f')").findings
    assert found.message.startswith("the variable D decides while the file is read")


def test_difference_of_the_plans_is_printed() -> None:
    body = "Node(package='p', executable='e', parameters=[{'a': os.path.join(os.getenv('D', ''), 'f')}])"
    (found,) = convert(body).findings
    assert "does not start the same" in found.message
    assert [note.message for note in found.notes] == [
        "- node /e: parameter a = 'f'",
        "+ node /e: parameter a = '/f'",
    ]


@pytest.mark.parametrize(
    ("path", "expected"),
    [("/a/b.launch.py", "/a/b.launch.xml"), ("/a/b_launch.py", "/a/b_launch.xml"), ("/a/b.py", "/a/b.launch.xml")],
)
def test_name_says_the_language(path: str, expected: str) -> None:
    assert name_in(path, "xml") == expected
