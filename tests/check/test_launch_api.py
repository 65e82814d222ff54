"""Launch files of ROS 2 in three languages, checked like the others."""

from __future__ import annotations

import pytest

from ur.check.cache.recall import Recall
from ur.check.session import CheckReport, check_paths
from ur.launchfile.world import MemoryWorld
from ur.source.diagnostic import Severity

HEAD = """import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, IncludeLaunchDescription
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command, EnvironmentVariable, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
"""
INCLUDE = (
    "IncludeLaunchDescription(PathJoinSubstitution([FindPackageShare('demo'), 'launch', '{}']), "
    "launch_arguments={{{}}}.items())"
)
NAMESPACED = "Node(package='demo', executable='talker', namespace=LaunchConfiguration('namespace'))"
PACKAGES = {"demo": "/w/demo"}


def python(*entities: str, before: str = "pass") -> str:
    """Return a launch file in Python."""
    return f"{HEAD}    {before}\n    return LaunchDescription([\n        {', '.join(entities)}\n    ])\n"


def check(files: dict[str, str], *paths: str, recall: Recall | None = None) -> CheckReport:
    """Check a package `demo` with files in its folder."""
    whole = {"/w/demo/package.xml": "<package><name>demo</name></package>"}
    whole |= {f"/w/demo/{name}": text for name, text in files.items()}
    return check_paths(paths or ["/w"], MemoryWorld(whole, PACKAGES), recall=recall)


def rules(report: CheckReport) -> list[str]:
    """Return the rules of findings, in the order of places."""
    return [found.rule for found in report.findings]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.launch.py", python("Node(package='demo', executable='talker', parameters=['/w/demo/config/none.yaml'])")),
        (
            "a.launch.xml",
            '<launch><node pkg="demo" exec="talker"><param from="$(find-pkg-share demo)/config/none.yaml"/></node>'
            "</launch>",
        ),
        (
            "a.launch.yaml",
            "launch:\n- node:\n    pkg: demo\n    exec: talker\n    param:\n"
            "    - from: $(find-pkg-share demo)/config/none.yaml\n",
        ),
    ],
)
def test_missing_parameter_file_is_found_in_every_language(name: str, text: str) -> None:
    report = check({f"launch/{name}": text})
    assert rules(report) == ["missing-file"]
    assert report.findings[0].span is not None
    assert "/w/demo/config/none.yaml: no such file" in report.findings[0].message
    assert report.files == 1


def test_folder_launch_holds_launch_files_with_any_name_in_python() -> None:
    broken = python("nothing")
    report = check({"launch/robot.py": broken, "demo/helper.py": broken, "launch/helper.py": "import nothing\n"})
    assert [str(found.span) for found in report.findings] == ["/w/demo/launch/robot.py:15:9"]


def test_tests_of_launch_testing_are_no_launch_files() -> None:
    report = check({"test/talk.launch.py": "def generate_test_description():\n    return nothing\n"})
    assert (rules(report), report.files) == ([], 0)


def test_argument_without_default_is_given_when_the_file_is_started() -> None:
    text = python(
        "DeclareLaunchArgument('map')",
        "DeclareLaunchArgument('model', default_value='', choices=['lite', 'standard'])",
        "Node(package='demo', executable='talker', parameters=[{'map': LaunchConfiguration('map')}])",
        "GroupAction([], condition=IfCondition(LaunchConfiguration('map')))",
    )
    report = check({"launch/a.launch.py": text})
    assert (rules(report), report.gaps) == ([], ())


def test_variable_of_the_environment_may_be_set_where_the_file_is_used() -> None:
    text = python(
        "Node(package='demo', executable='talker', parameters=[path, '/w/demo/' + os.getenv('OTHER', '') + '.yaml'])",
        "Node(package='demo', executable=EnvironmentVariable('PROGRAM'))",
        before="path = os.path.join(get_package_share_directory('demo'), os.environ['ROBOT_MODEL'] + '.yaml')",
    )
    assert rules(check({"launch/a.launch.py": text})) == []


def test_value_of_an_including_file_is_an_error_alone_and_a_warning_when_included() -> None:
    part = python(NAMESPACED, NAMESPACED)
    (alone,) = check({"launch/part.launch.py": part}).findings
    assert (alone.rule, alone.severity) == ("undeclared-argument", Severity.ERROR)
    assert alone.help == "declare it before: DeclareLaunchArgument('namespace')"
    top = python(INCLUDE.format("part.launch.py", "'namespace': 'robot'"))
    (included,) = check({"launch/part.launch.py": part, "launch/top.launch.py": top}).findings
    assert (included.rule, included.severity) == ("undeclared-argument", Severity.WARNING)
    assert included.message.endswith("the file cannot be started alone")
    assert str(included.notes[0].span).startswith("/w/demo/launch/top.launch.py:")


def test_argument_that_an_included_file_neither_declares_nor_uses_is_marked_where_it_is_written() -> None:
    part = python("DeclareLaunchArgument('speed', default_value='1')", NAMESPACED)
    top = python(INCLUDE.format("part.launch.py", "'namespace': 'a', 'sped': '2'"))
    report = check({"launch/part.launch.py": part, "launch/top.launch.py": top})
    found = [each for each in report.findings if each.rule == "unknown-argument"]
    assert [(each.span.text if each.span else "", each.help, each.severity) for each in found] == [
        ("sped", "did you mean speed?", Severity.WARNING)
    ]


def test_package_that_is_not_installed_is_one_warning_per_file_and_no_gap() -> None:
    include = "IncludeLaunchDescription([FindPackageShare('far_away'), '/launch/a.launch.py'])"
    report = check({"launch/a.launch.py": python(include, include)})
    assert rules(report) == ["package-not-installed"]
    assert report.findings[0].severity is Severity.WARNING
    assert report.gaps == ()


def test_missing_file_of_a_package_that_is_installed_is_an_error() -> None:
    include = "IncludeLaunchDescription([FindPackageShare('demo'), '/launch/prat.launch.py'])"
    report = check({"launch/a.launch.py": python(include), "launch/part.launch.py": python()})
    assert rules(report) == ["missing-file"]
    assert report.findings[0].help == "did you mean /w/demo/launch/part.launch.py?"


def test_output_of_a_command_is_no_gap() -> None:
    text = python("Node(package='demo', executable='talker', parameters=[{'text': Command(['xacro ', 'a.xacro'])}])")
    assert check({"launch/a.launch.py": text}).gaps == ()


def test_comment_hides_a_finding_in_python() -> None:
    line = "Node(package='demo', node_executable='talker')"
    text = python(line).replace(line, f"{line}  # ur: ignore launch-argument: for Dashing")
    report = check({"launch/a.launch.py": text})
    assert (rules(report), report.suppressed) == ([], 1)


def test_second_check_recalls_findings_and_gaps() -> None:
    text = python("Node(package='demo', executable=name, node_name='a')", before="name = os.popen('id').read()")
    first = Recall()
    found = check({"launch/a.launch.py": text}, recall=first)
    second = Recall(first.now)
    again = check({"launch/a.launch.py": text}, recall=second)
    assert second.recalled == 1
    assert rules(found) == rules(again) == ["launch-argument"]
    assert [each.message for each in found.gaps] == [each.message for each in again.gaps] != []


def test_two_nodes_of_one_name_are_a_warning_unless_one_starts_after_the_other() -> None:
    node = '<node pkg="demo" exec="talker" name="talker"/>'
    report = check({"launch/a.launch.xml": f"<launch>{node}{node}</launch>"})
    assert [(each.rule, each.severity) for each in report.findings] == [("duplicate-node", Severity.WARNING)]
    later = f'<launch>{node}<timer period="5">{node}</timer></launch>'
    assert rules(check({"launch/a.launch.xml": later})) == []


def test_file_for_ros_1_that_includes_one_for_ros_2_is_refused() -> None:
    files = {
        "launch/a.launch": '<launch><include file="$(find demo)/launch/b.launch"/></launch>',
        "launch/b.launch": '<launch><let name="a" value="1"/></launch>',
    }
    report = check(files)
    assert rules(report) == ["wrong-ros-version"]
    assert str(report.findings[0].notes[0].span) == "/w/demo/launch/a.launch:1:9"


def test_broken_xml_of_a_file_for_ros_2_is_reported() -> None:
    report = check({"launch/a.launch.xml": '<launch><let name="a" value="1"/><group></launch>'})
    assert rules(report) == ["bad-xml"]


ARGUMENT = "DeclareLaunchArgument('mode', default_value='slow'{})"
USE = "Node(package='demo', executable=LaunchConfiguration('mode'))"
IF = "Node(package='demo', executable='a', condition=IfCondition({}))"
CHOICES = ", choices=['slow', 'fast']"
TEXT = "['\"', LaunchConfiguration('mode'), '\" == \"{}\"']"


@pytest.mark.parametrize(
    ("entities", "found"),
    [
        ((ARGUMENT.format(""),), ["unused-argument"]),
        ((ARGUMENT.format(""), USE), []),
        ((ARGUMENT.format(""), IF.format("'false'").replace("'a'", "LaunchConfiguration('mode')")), []),
        ((ARGUMENT.format(""), INCLUDE.format("part.launch.py", "")), []),
        ((ARGUMENT.format(""), ARGUMENT.format("").replace("slow", "fast"), USE), ["duplicate-arg"]),
        ((ARGUMENT.format(""), ARGUMENT.format(""), USE), []),
        ((*(f"GroupAction([{ARGUMENT.format('').replace('slow', each)}, {USE}])" for each in "ab"),), []),
        (
            (ARGUMENT.format(CHOICES), IF.format(f"PythonExpression({TEXT.format('fats')})")),
            ["useless-condition"],
        ),
        ((ARGUMENT.format(CHOICES), IF.format(f"PythonExpression({TEXT.format('fast')})")), []),
        (
            (ARGUMENT.format(CHOICES), IF.format("EqualsSubstitution(LaunchConfiguration('mode'), 'fats')")),
            ["useless-condition"],
        ),
        ((ARGUMENT.format(""), IF.format("EqualsSubstitution(LaunchConfiguration('mode'), 'fats')")), []),
    ],
)
def test_argument_that_cannot_have_an_effect_is_found(entities: tuple[str, ...], found: list[str]) -> None:
    part = python("Node(package='demo', executable=LaunchConfiguration('mode', default='a'))")
    imports = "from launch.substitutions import EqualsSubstitution, PythonExpression"
    files = {"launch/a.launch.py": python(*entities, before=imports), "launch/part.launch.py": part}
    assert [rule for rule in rules(check(files, "/w/demo/launch/a.launch.py")) if rule != "missing-executable"] == found


@pytest.mark.parametrize(
    ("build", "found"),
    [
        ("add_executable(talkr src/main.cpp)", ["missing-executable"]),
        ("add_executable(talker src/talker.cpp)", []),
        ("add_executable(${name} src/talker.cpp)", []),
        ("project(demo)\nadd_executable(${PROJECT_NAME}_talker a.cpp)", ["missing-executable"]),
        ("install(PROGRAMS scripts/talker DESTINATION lib/demo)", []),
    ],
)
def test_executable_that_no_build_rule_makes_is_found(build: str, found: list[str]) -> None:
    node = python("Node(package='demo', executable='talker')")
    assert rules(check({"launch/a.launch.py": node, "CMakeLists.txt": build})) == found


def test_executable_that_is_installed_is_found_by_its_folder() -> None:
    files = {
        "/o/share/demo/package.xml": "<package><name>demo</name></package>",
        "/o/lib/demo/talker": "",
        "/o/share/demo/launch/a.launch.py": python("Node(package='demo', executable='tolker')"),
    }
    (found,) = check_paths(["/o/share/demo"], MemoryWorld(files, {"demo": "/o/share/demo"})).findings
    assert (found.rule, found.help) == ("missing-executable", "did you mean talker?")


def test_section_below_a_namespace_that_is_not_known_is_not_reported() -> None:
    rewritten = "RewrittenYaml(source_file='/w/demo/p.yaml', root_key=EnvironmentVariable('ROBOT'), param_rewrites={})"
    text = python(
        f"Node(package='demo', executable='talker', name='talker', parameters=[{rewritten}])",
        before="from nav2_common.launch import RewrittenYaml",
    )
    assert not check({"a.launch.py": text, "p.yaml": "talker:\n  ros__parameters: {a: 1}\n"}).findings
