"""Scopes: configurations, namespaces, remaps, environment and parameters, in includes, groups and forwarding."""

import pytest
from tests.launchfile.ros2.plans import describe_all, load, load_clean, parameters, python, rules, xml

INNER = python("SetLaunchConfiguration('a', 'inner')", "PushRosNamespace('in')", "SetEnvironmentVariable('E', '1')")
NODE = "Node(executable=LaunchConfiguration('a', default='none'))"
INCLUDE = "IncludeLaunchDescription('/ws/b.launch.py')"
SCOPES = {
    "an include leaks": ([INCLUDE, NODE], ["node /in/inner /inner E=1"]),
    "a group ends it": ([f"GroupAction([{INCLUDE}])", NODE], ["node /none /none"]),
    "a group without scope leaks": ([f"GroupAction([{INCLUDE}], scoped=False)", NODE], ["node /in/inner /inner E=1"]),
    "arguments of an include leak": (
        ["IncludeLaunchDescription('/ws/c.launch.py', launch_arguments={'a': 'passed'}.items())", NODE],
        ["node /passed /passed"],
    ),
    "a group forwards": (["SetLaunchConfiguration('a', 'x')", f"GroupAction([{NODE}])"], ["node /x /x"]),
    "a group does not forward": (
        ["SetLaunchConfiguration('a', 'x')", f"GroupAction([{NODE}], forwarding=False)", NODE],
        ["node /none /none", "node /x /x"],
    ),
    "a group without forwarding is given some": (
        ["SetLaunchConfiguration('a', 'x')",
         f"GroupAction([{NODE}], forwarding=False, launch_configurations={{'a': LaunchConfiguration('a')}})"],
        ["node /x /x"],
    ),
    "a group sets configurations": ([f"GroupAction([{NODE}], launch_configurations={{'a': 'y'}})", NODE],
                                    ["node /y /y", "node /none /none"]),
    "an argument is not declared anew": (
        ["SetLaunchConfiguration('a', 'first')", "DeclareLaunchArgument('a', default_value='second')", NODE],
        ["node /first /first"],
    ),
    "order decides": ([NODE, "SetLaunchConfiguration('a', 'late')"], ["node /none /none"]),
    "what a timer starts sees the end": (
        [f"TimerAction(period=1.0, actions=[{NODE}])", "SetLaunchConfiguration('a', 'late')"],
        ["node /late /late when timer 1.0"],
    ),
    "namespaces are joined": (
        ["PushRosNamespace('a')", "PushRosNamespace('b')", "Node(executable='n', namespace='c')",
         "Node(executable='n', namespace='/d')", "PushRosNamespace('/e')", "Node(executable='n')"],
        ["node /a/b/c/n /n", "node /d/n /n", "node /e/n /n"],
    ),
    "an empty namespace changes nothing": (
        ["PushRosNamespace('')", "Node(executable='n', namespace='')"], ["node /n /n"]
    ),
    "remaps of outer scopes come first": (
        ["SetRemap('a', 'b')", "GroupAction([SetRemap('c', 'd'), Node(executable='n', remappings=[('e', 'f')])])",
         "Node(executable='m')"],
        ["node /n /n a:=b c:=d e:=f", "node /m /m a:=b"],
    ),
    "environment ends with a group": (
        ["GroupAction([SetEnvironmentVariable('A', '1'), Node(executable='n')])", "Node(executable='m')"],
        ["node /n /n A=1", "node /m /m"],
    ),
    "the container of components is not in the namespace of the scope": (
        ["Node(executable='c', name='c')", "PushRosNamespace('g')", "LoadComposableNodes(target_container='c', "
         "composable_node_descriptions=[ComposableNode(package='p', plugin='X', name='x')])"],
        ["node /c /c", "component /g/x p/X in /c"],
    ),
    "a component is in the namespace of its scope": (
        ["GroupAction([PushRosNamespace('g'), ComposableNodeContainer(name='c', namespace='', package='p', "
         "executable='e', composable_node_descriptions=[ComposableNode(package='p', plugin='X', name='x')])])"],
        ["container /g/c p/e", "component /g/x p/X in /g/c"],
    ),
}  # fmt: skip


@pytest.mark.parametrize(("actions", "expected"), SCOPES.values(), ids=SCOPES)
def test_scope_is_that_of_upstream(actions: list[str], expected: list[str]) -> None:
    files = {"/ws/b.launch.py": INNER, "/ws/c.launch.py": python("DeclareLaunchArgument('a')")}
    assert describe_all(load_clean(python(*actions), files=files)) == expected


def test_file_that_only_an_including_file_completes_is_an_error_alone() -> None:
    inner = python("Node(executable=LaunchConfiguration('a'))")
    assert rules(load(inner)) == ["undeclared-argument"]
    outer = python("DeclareLaunchArgument('a', default_value='x')", INCLUDE)
    assert describe_all(load_clean(outer, files={"/ws/b.launch.py": inner})) == ["node /x /x"]


def test_argument_that_an_included_file_does_not_declare_is_a_warning() -> None:
    inner = {"/ws/b.launch.py": python("DeclareLaunchArgument('speed', default_value='1')")}
    plan = load(
        python("IncludeLaunchDescription('/ws/b.launch.py', launch_arguments={'sped': '1'}.items())"), files=inner
    )
    assert rules(plan) == ["unknown-argument"]
    assert plan.diagnostics[0].help == "did you mean speed?"
    assert rules(plan, errors=True) == []


def test_includes_are_recorded_with_what_they_pass() -> None:
    inner = {"/ws/b.launch.xml": xml('<arg name="x" default=""/>')}
    plan = load_clean(
        python(
            "PushRosNamespace('g')", "IncludeLaunchDescription(['/ws/', 'b.launch.xml'], launch_arguments=[('x', '1')])"
        ),
        files=inner,
    )
    assert [(each.file, each.namespace, each.arguments) for each in plan.includes] == [
        ("/ws/b.launch.xml", "/g", (("x", "1"),))
    ]
    assert set(plan.files) >= {"/ws/a.launch.py", "/ws/b.launch.xml"}


def test_finding_in_an_included_file_names_the_includes() -> None:
    inner = {"/ws/b.launch.py": python("Node(executable=LaunchConfiguration('nothing'))")}
    found = load(python(INCLUDE), files=inner).diagnostics[0]
    assert found.span is not None
    assert found.span.file.path == "/ws/b.launch.py"


def test_global_parameters_reach_the_nodes_of_their_scope() -> None:
    actions = [
        "GroupAction([SetParameter('a', 1), SetUseSimTime(True), SetParametersFromFile('/p.yaml'),"
        " Node(executable='n', name='n', parameters=[{'b': 2}])])",
        "Node(executable='m', name='m')",
    ]
    plan = load_clean(python(*actions), files={"/p.yaml": "/**: {ros__parameters: {c: 3}}"})
    assert parameters(plan) == {"a": 1, "use_sim_time": True, "c": 3, "b": 2}
    assert parameters(plan, "/m") == {}


def test_parameter_of_a_node_takes_precedence_over_a_global_one() -> None:
    plan = load_clean(python("SetParameter('a', 1)", "Node(executable='n', name='n', parameters=[{'a': 2}])"))
    assert parameters(plan) == {"a": 2}


def test_environment_is_replaced_and_the_folder_of_logs_is_set() -> None:
    node = "Node(package='', executable='n', name='n', arguments=[ParameterSubstitution('rate', default='0')])"
    before = "from launch_ros.substitutions import Parameter as ParameterSubstitution"
    plan = load_clean(
        python(
            "SetParameter('rate', 5)", "ReplaceEnvironmentVariables({'A': 'b'})", "SetROSLogDir('/logs')", node,
            before=before,
        )
    )  # fmt: skip
    assert describe_all(plan) == ["node /n /n 5 A=b ROS_LOG_DIR=/logs without HOME without PATH without ROBOT"]


def test_actions_that_are_not_carried_out_are_named() -> None:
    plan = load(python("OpaqueCoroutine(coroutine=wait)", before="async def wait(context):\n    pass"))
    assert "OpaqueCoroutine is not carried out" in [gap.reason for gap in plan.gaps]


HANDLERS = """
first, last = OnProcessStart(on_start=[Node(executable='first')]), OnProcessExit(on_exit=[Node(executable='last')])
def register(handler):
    return RegisterEventHandler(handler)
"""


def test_event_handler_that_is_unregistered_causes_nothing() -> None:
    actions = ["register(first)", "register(last)", "UnregisterEventHandler(first)"]
    assert describe_all(load_clean(python(*actions, before=HANDLERS))) == ["node /last /last when exit 0.0"]
    later = "TimerAction(period=1.0, actions=[UnregisterEventHandler(first)])"
    plan = load_clean(python(*actions[:2], later, before=HANDLERS))
    assert [node.name for node in plan.nodes] == ["first", "last"]
    (action,) = plan.actions
    assert plan.nodes[0].trigger is not None
    assert (action.kind, action.text) == ("unregister", str(plan.nodes[0].trigger.handler))
    assert action.trigger is not None
    assert action.trigger.kind == "timer"


def test_event_handler_that_was_never_registered_is_a_mistake() -> None:
    plan = load(python("UnregisterEventHandler(first)", before=HANDLERS))
    assert [found.message for found in plan.diagnostics] == [
        "the event handler is not registered, expected one of a RegisterEventHandler before"
    ]


def test_launch_file_that_a_launch_file_writes_can_be_included() -> None:
    before = """
import tempfile
path = tempfile.mktemp(suffix='.launch.yaml')
with open(path, 'w') as file:
    file.write('launch: [{node: {pkg: demo, exec: talker}}]')
"""
    plan = load_clean(python("IncludeLaunchDescription(AnyLaunchDescriptionSource(path))", before=before))
    assert describe_all(plan) == ["node /talker demo/talker"]
