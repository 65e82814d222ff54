"""What is not known at any argument of the launch API is a gap, and the rest of the file is read; source trees."""

import pytest
from tests.launchfile.ros2.plans import FILES, PACKAGES, describe_all, load, load_clean, parameters, python

from ur.launchfile.ros2.load import load_ros2
from ur.launchfile.world.memory import MemoryWorld

BEFORE = "import numpy\nx = numpy.zeros(3)"
TEXTS = (  # substitutions, each with what is not known
    "EnvironmentVariable(x)", "FindExecutable(name=x)", "FileContent(x)", "AnonName(x)", "PythonExpression(x)",
    "PathJoinSubstitution(x)", "PathJoinSubstitution(['a', x])", "FindPackageShare(x)", "FindPackagePrefix(x)",
    "ExecutableInPackage(x, 'demo')", "EqualsSubstitution(x, 'a')", "NotEqualsSubstitution('a', x)",
    "AndSubstitution(x, 'true')", "OrSubstitution('false', x)", "NotSubstitution(x)", "AnySubstitution(x)",
    "AllSubstitution('true', x)", "IfElseSubstitution(x, 'a', 'b')", "LaunchConfiguration(x)",
    "StringJoinSubstitution([x], ',')", "TextSubstitution(text=x)", "Command(x)", "['a', x]", "[x] + ['a']",
    "'a' + str(x)", "f'{x}'", "x.y", "x['a']", "x(1)", "-x", "x + 1", "x < 1", "x and 'a'", "('a' if x else 'b')",
    "[a for a in x][0]", "{'a': x}['a']", "str(LaunchConfiguration('a'))",
)  # fmt: skip
ACTIONS = (
    "ExecuteProcess(cmd=['a'], additional_env=x)", "ExecuteProcess(cmd=['a'], shell=x)",
    "Node(executable='a', parameters=x)",
    "Node(executable='a', parameters=[x])", "Node(executable='a', parameters=[{'a': x}])",
    "Node(executable='a', parameters=[{x: 1}])", "Node(executable='a', parameters=[{'a': [1, x]}])",
    "Node(executable='a', parameters=[ParameterFile(x)])", "Node(executable='a', parameters=[[x, '/a']])",
    "Node(executable='a', parameters=[{'a': ParameterValue(x, value_type=str)}])", "Node(executable='a', remappings=x)",
    "Node(executable='a', remappings=[x])", "Node(executable='a', condition=x)", "Node(executable='a', respawn=x)",
    "Node(executable='a', condition=IfCondition(x))", "Node(executable='a', condition=UnlessCondition(x))",
    "Node(executable='a', condition=LaunchConfigurationEquals(x, 'a'))",
    "GroupAction(x)", "GroupAction([Node(executable='a')], scoped=x)", "IncludeLaunchDescription(x)",
    "IncludeLaunchDescription('/ws/b.launch.py', launch_arguments=x)",
    "IncludeLaunchDescription('/ws/b.launch.py', launch_arguments=[x])", "OpaqueFunction(function=x)",
    "OpaqueFunction(function=lambda context, a: [], args=x)", "OpaqueFunction(function=lambda context: x)",
    "ForLoop(x, function=lambda i: [])", "ForEach(x, function=lambda a: [])", "ForLoop('2', function=x)",
    "RegisterEventHandler(x)", "RegisterEventHandler(OnProcessExit(on_exit=lambda event, context: [event]))",
    "SetParameter('a', x)", "SetParametersFromFile(x)", "SetRemap(x, 'a')", "PushRosNamespace(x)", "x",
    "LoadComposableNodes(target_container='/c', composable_node_descriptions=x)",
    "LoadComposableNodes(target_container='/c', composable_node_descriptions=[x])",
    "LoadComposableNodes(target_container='/c', composable_node_descriptions="
    "[ComposableNode(package='demo', plugin='A', condition=IfCondition(x))])",
)  # fmt: skip


@pytest.mark.parametrize("text", TEXTS)
def test_text_that_is_not_known_is_a_gap_and_hides_no_other_node(text: str) -> None:
    plan = load(python(f"Node(executable='n', arguments=['a', {text}])", "Node(executable='after')", before=BEFORE))
    assert plan.gaps
    assert [node.name for node in plan.nodes] == ["n", "after"]
    assert plan.nodes[0].words[0] == "a"


@pytest.mark.parametrize("action", ACTIONS)
def test_action_with_what_is_not_known_is_a_gap_and_hides_no_other(action: str) -> None:
    plan = load(
        python("Node(executable='before')", action, "Node(executable='after')", before=BEFORE),
        files={"/ws/b.launch.py": python()},
    )
    assert plan.gaps
    assert [plan.nodes[0].name, plan.nodes[-1].name] == ["before", "after"]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("Path('/a/b.c').name + Path('/a/b.c').suffix", "b.c.c"),
        ("Path('/a').joinpath('b', 'c').as_posix()", "/a/b/c"),
        ("Path('/a/b.c').with_suffix('.d').resolve()", "/a/b.d"),
        ("Path('/a/b').parents[0]", "/a"),
        ("Path('/a/b').parts[1]", "a"),
    ],
)
def test_paths_are_computed(text: str, value: str) -> None:
    before = f"from pathlib import Path\nx = str({text})"
    assert load_clean(python("ExecuteProcess(cmd=['x', x])", before=before)).nodes[0].words == (value,)


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        ("f()", "needs 'a'"),
        ("f(1, 2)", "has 2 arguments"),
        ("f(1, b=2)", "has no argument 'b'"),
    ],
)
def test_call_that_python_refuses_is_a_gap_with_the_reason(call: str, reason: str) -> None:
    plan = load(python(f"Node(executable='n', arguments=[{call}])", before="def f(a):\n    return a"))
    assert [reason in gap.reason for gap in plan.gaps] == [True]


@pytest.mark.parametrize("context", ["context.locals", "context.launch_configurations['a']"])
def test_function_reads_the_context(context: str) -> None:
    before = f"def f(context):\n    return [Node(executable=str({context}))]"
    plan = load(python("SetLaunchConfiguration('a', 'talker')", "OpaqueFunction(function=f)", before=before))
    known = "configurations" in context
    assert bool(plan.gaps) is not known
    assert [node.type for node in plan.nodes] == (["talker"] if known else plan.nodes and [plan.nodes[0].type])


def test_file_of_a_source_tree_is_found_where_its_build_takes_it_from() -> None:
    share = PACKAGES["demo"]
    tree = {f"{share}/CMakeLists.txt": "", f"{share}/bringup/config/base.yaml": "/**: {ros__parameters: {a: 1}}"}
    tree |= {
        f"{share}/other/base.yaml": "",
        f"{share}/bringup/launch/part.launch.py.in": python("Node(executable='b')"),
    }
    text = python(
        "Node(executable='a', parameters=[PathJoinSubstitution([FindPackageShare('demo'), 'config', 'base.yaml'])])",
        "IncludeLaunchDescription(PathJoinSubstitution([FindPackageShare('demo'), 'launch', 'part.launch.py']))",
    )
    plan = load_clean(text, files=tree)
    assert [each.value for each in plan.params] == [1]
    assert describe_all(plan) == ["node /a /a", "node /b /b"]
    installed = load(text, files={name: each for name, each in tree.items() if not name.endswith("CMakeLists.txt")})
    assert [found.rule for found in installed.diagnostics] == ["missing-file", "missing-file"]
    none = load(text, files={f"{share}/setup.py": ""})
    assert [found.rule for found in none.diagnostics] == ["missing-file", "missing-file"]


def test_file_that_cannot_be_read_or_is_no_text_is_one_line() -> None:
    plan = load_ros2("/ws/none.launch.py", (), MemoryWorld(FILES, PACKAGES, {}))
    assert [found.rule for found in plan.diagnostics] == ["missing-file"]
    plan = load_ros2("/ws/a.launch.xml", (), MemoryWorld({"/ws/a.launch.xml": b"\xff\xfe\xfa"}, PACKAGES, {}))
    assert [found.rule for found in plan.diagnostics] == ["unreadable-file"]


@pytest.mark.parametrize(
    ("action", "rule"),
    [
        ("ExecuteProcess(cmd=[FileContent('/none')])", "missing-file"),
        ("ExecuteProcess(cmd=[ForLoopIndex('i')])", "undeclared-argument"),
        ("ExecuteProcess(cmd=[LaunchConfigAsBool('none')])", "undeclared-argument"),
        ("ExecuteProcess(cmd=[EqualsSubstitution('a', Node(executable='b'))])", "launch-value"),
        ("Node(executable='a', condition='true')", "launch-value"),
        ("IfCondition('true')", "launch-value"),
        ("TimerAction(period='soon', actions=[])", "bad-number"),
        ("RegisterEventHandler('exit')", "launch-value"),
        ("Node(executable='a', parameters='p.yaml')", "launch-value"),
        ("Node(executable='a', parameters=[5])", "launch-value"),
        ("Node(executable='a', remappings=[('b',)])", "launch-value"),
        ("Node(executable='a', name='b/c')", "bad-name"),
        ("Node(executable='a', namespace='b c')", "bad-name"),
    ],
)
def test_value_that_upstream_refuses_is_one_finding_at_its_place(action: str, rule: str) -> None:
    plan = load(python(action, "Node(executable='after')", before="from nav2_common.launch import LaunchConfigAsBool"))
    assert [(found.rule, found.span is not None) for found in plan.diagnostics] == [(rule, True)]
    assert plan.nodes[-1].name == "after"


@pytest.mark.parametrize(
    ("cmd", "words"),
    [
        ("a $(env ROBOT) c d e", ("r2", "c", "d", "e")),
        ("a$(env ROBOT)b c", ("c",)),
        ("$(env ROBOT) $(env HOME)", ("/home/robot",)),
        ("a '$(env ROBOT) b'", None),
    ],
)
def test_command_line_of_xml_is_split_as_upstream_does(cmd: str, words: tuple[str, ...] | None) -> None:
    plan = load(f'<launch><executable cmd="{cmd}"/></launch>', "/ws/a.launch.xml")
    assert [node.words for node in plan.nodes] == ([] if words is None else [words])
    assert [found.rule for found in plan.diagnostics] == (["launch-value"] if words is None else [])


def test_function_that_an_event_calls_starts_what_is_certain() -> None:
    before = "def f(event, context):\n    return [Node(executable='b'), LogInfo(msg='c')]"
    actions = ["Node(executable='a', name='a')", "RegisterEventHandler(OnProcessExit(on_exit=f))"]
    plan = load_clean(python(*actions, before=before))
    assert [(node.name, node.trigger and node.trigger.kind) for node in plan.nodes] == [("a", None), ("b", "exit")]


def test_function_that_asks_an_event_is_a_gap() -> None:
    before = "def f(event, context):\n    return [Node(executable='b')] if event.returncode == 0 else []"
    plan = load(python("RegisterEventHandler(OnProcessExit(on_exit=f))", before=before))
    assert ["an event decides" in gap.reason for gap in plan.gaps] == [True]


def test_program_that_the_file_runs_is_named_with_its_line() -> None:
    plan = load(python("Node(executable='a')", before="import subprocess\nsubprocess.run(['date'])"))
    assert [(gap.reason, gap.kind) for gap in plan.gaps] == [("a program is not run while reading: run()", "")]
    assert plan.gaps[0].origin is not None
    assert "subprocess.run" in plan.gaps[0].origin.span.text


@pytest.mark.parametrize(
    "text",
    [
        "import subprocess, sys\nsys.exit(subprocess.call(['teleop']))\n",
        "import launch_testing\ndef generate_launch_description(node_type):\n    return None\n",
    ],
)
def test_file_that_is_no_description_on_purpose_is_a_gap(text: str) -> None:
    plan = load(text)
    assert plan.gaps
    assert not plan.diagnostics


def test_list_that_gets_what_is_not_known_is_not_empty() -> None:
    before = "import socket\nnames = []\nfor each in socket.gethostname():\n    names.append(each)"
    plan = load(python("Node(executable='e', name='n', parameters=[{'a': names}])", before=before))
    assert plan.gaps
    assert not plan.diagnostics


def test_value_that_a_build_sets_is_named_in_a_template() -> None:
    action = "Node(executable='@NAME@')"
    plan = load(python(action), "/ws/a.launch.py.in")
    assert [(gap.reason, gap.kind) for gap in plan.gaps] == [("@NAME@ is set when its package is built", "package")]
    assert load_clean(python(action)).nodes[0].type == "@NAME@"


def test_module_that_is_not_installed_is_a_package_that_is_missing() -> None:
    plan = load(python("Node(executable=x)", before="from moveit_configs_utils import x"))
    assert [gap.kind for gap in plan.gaps] == ["package"]


def test_group_whose_configurations_are_not_known_hides_those_that_it_uses() -> None:
    group = "GroupAction([Node(executable=LaunchConfiguration('a'))], forwarding=False, launch_configurations=x)"
    plan = load(python(group, "Node(executable='b')", before="import numpy\nx = numpy.a()"))
    assert not plan.diagnostics
    assert [node.name for node in plan.nodes][1:] == ["b"]
    assert plan.gaps


def test_arguments_of_a_description_are_handed_over() -> None:
    before = "d = LaunchDescription([DeclareLaunchArgument('a', default_value='b')])"
    given = "launch_configurations={e.name: LaunchConfiguration(e.name) for e in d.get_launch_arguments()}"
    group = f"GroupAction([Node(executable=LaunchConfiguration('a'))], forwarding=False, {given})"
    plan = load_clean(python("*d.entities", group, before=before))
    assert [node.name for node in plan.nodes] == ["b"]


def test_parameters_of_a_file_that_is_written_are_known() -> None:
    before = (
        "import yaml, tempfile\nwith tempfile.NamedTemporaryFile('w', delete=False) as f:\n"
        "    yaml.dump({'n': {'ros__parameters': {'a': 1}}}, f)"
    )
    plan = load_clean(python("Node(executable='n', name='n', parameters=[f.name])", before=before))
    assert parameters(plan) == {"a": 1}
