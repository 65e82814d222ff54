"""Each action of `launch` and `launch_ros` becomes the same plan in Python, XML and YAML."""

from __future__ import annotations

import pytest
from tests.launchfile.ros2.plans import describe_all, load, load_clean, python, rules, xml

INCLUDED = {
    "/ws/b.launch.py": python(
        "DeclareLaunchArgument('x', default_value='0')", "Node(executable=LaunchConfiguration('x'))"
    )
}
NODE = "Node(package='demo', executable='talker', name='n'{})"
CASES = {
    "node": (
        [NODE.format(", namespace='ns', arguments=['-a', 'b c'], remappings=[('x', 'y')], additional_env={'E': '1'}")],
        '<node pkg="demo" exec="talker" name="n" namespace="ns" args="-a \'b c\'">'
        '<remap from="x" to="y"/><env name="E" value="1"/></node>',
        "- node: {pkg: demo, exec: talker, name: n, namespace: ns, args: \"-a 'b c'\","
        " remap: [{from: x, to: y}], env: [{name: E, value: '1'}]}",
        ["node /ns/n demo/talker -a b c x:=y E=1"],
    ),
    "arguments of ROS": (
        [NODE.format(", ros_arguments=['--log-level', 'debug']")],
        '<node pkg="demo" exec="talker" name="n" ros_args="--log-level debug"/>',
        "- node: {pkg: demo, exec: talker, name: n, ros_args: --log-level debug}",
        ["node /n demo/talker --ros-args --log-level debug"],
    ),
    "lifecycle node": (
        ["LifecycleNode(package='demo', executable='life', name='n', namespace='')"],
        '<lifecycle_node pkg="demo" exec="life" name="n" namespace=""/>',
        "- lifecycle_node: {pkg: demo, exec: life, name: n, namespace: ''}",
        ["lifecycle /n demo/life"],
    ),
    "program": (
        ["ExecuteProcess(cmd=['echo', 'a b', 'c'], name='p', additional_env={'E': '1'})"],
        '<executable cmd="echo \'a b\' c" name="p"><env name="E" value="1"/></executable>',
        "- executable: {cmd: \"echo 'a b' c\", name: p, env: [{name: E, value: '1'}]}",
        ["program /p /echo a b c E=1"],
    ),
    "argument": (
        ["DeclareLaunchArgument('a', default_value='t', description='d', choices=['t', 'u'])",
         "Node(executable=LaunchConfiguration('a'))"],
        '<arg name="a" default="t" description="d"><choice value="t"/><choice value="u"/></arg>'
        '<node pkg="" exec="$(var a)"/>',
        "- arg: {name: a, default: t, description: d, choice: [{value: t}, {value: u}]}\n"
        "- node: {pkg: '', exec: $(var a)}",
        ["node /t /t"],
    ),
    "configuration": (
        ["SetLaunchConfiguration('a', 't')", "Node(executable=LaunchConfiguration('a'))",
         "UnsetLaunchConfiguration('a')", "Node(executable=LaunchConfiguration('a', default='gone'))"],
        '<let name="a" value="t"/><node pkg="" exec="$(var a)"/><unset name="a"/><node pkg="" exec="$(var a gone)"/>',
        "- let: {name: a, value: t}\n- node: {pkg: '', exec: $(var a)}\n- unset: {name: a}\n"
        "- node: {pkg: '', exec: $(var a gone)}",
        ["node /t /t", "node /gone /gone"],
    ),
    "include": (
        ["IncludeLaunchDescription(PythonLaunchDescriptionSource('/ws/b.launch.py'), "
         "launch_arguments={'x': 'y'}.items())"],
        '<include file="/ws/b.launch.py"><arg name="x" value="y"/></include>',
        "- include: {file: /ws/b.launch.py, arg: [{name: x, value: y}]}",
        ["node /y /y"],
    ),
    "include with let": (
        ["IncludeLaunchDescription('/ws/b.launch.py', launch_arguments=[('x', ['y', 'z'])])"],
        '<include file="/ws/b.launch.py"><let name="x" value="yz"/></include>',
        "- include: {file: /ws/b.launch.py, let: [{name: x, value: yz}]}",
        ["node /yz /yz"],
    ),
    "group with namespace": (
        ["GroupAction([PushRosNamespace('g'), Node(executable='in')])", "Node(executable='out')"],
        '<group><push_ros_namespace namespace="g"/><node pkg="" exec="in"/></group><node pkg="" exec="out"/>',
        "- group: [{push_ros_namespace: {namespace: g}}, {node: {pkg: '', exec: in}}]\n- node: {pkg: '', exec: out}",
        ["node /g/in /in", "node /out /out"],
    ),
    "group that keeps what is set": (
        ["GroupAction([PushRosNamespace('g')], scoped=False)", "Node(executable='out')"],
        '<group scoped="false"><push-ros-namespace namespace="g"/></group><node pkg="" exec="out"/>',
        "- group:\n    scoped: false\n    children:\n    - push_ros_namespace: {namespace: g}\n"
        "- node: {pkg: '', exec: out}",
        ["node /g/out /out"],
    ),
    "environment": (
        ["SetEnvironmentVariable('A', '1')", "AppendEnvironmentVariable('A', '2')",
         "AppendEnvironmentVariable('A', '0', prepend=True, separator=';')", "UnsetEnvironmentVariable('ROBOT')",
         "Node(executable='n')"],
        '<set_env name="A" value="1"/><append_env name="A" value="2"/><append_env name="A" value="0" prepend="true"'
        ' separator=";"/><unset_env name="ROBOT"/><node pkg="" exec="n"/>',
        "- set_env: {name: A, value: '1'}\n- append_env: {name: A, value: '2'}\n"
        "- append_env: {name: A, value: '0', prepend: true, separator: ;}\n- unset_env: {name: ROBOT}\n"
        "- node: {pkg: '', exec: n}",
        ["node /n /n A=0;1:2 without ROBOT"],
    ),
    "environment that is reset": (
        ["SetEnvironmentVariable('A', '1')", "ResetEnvironment()", "Node(executable='n')"],
        '<set_env name="A" value="1"/><reset_env/><node pkg="" exec="n"/>',
        "- set_env: {name: A, value: '1'}\n- reset_env: {}\n- node: {pkg: '', exec: n}",
        ["node /n /n"],
    ),
    "remap of a scope": (
        ["SetRemap('x', 'y')", "Node(executable='n', remappings=[('a', 'b')])"],
        '<set_remap from="x" to="y"/><node pkg="" exec="n"><remap from="a" to="b"/></node>',
        "- set_remap: {from: x, to: y}\n- node: {pkg: '', exec: n, remap: [{from: a, to: b}]}",
        ["node /n /n x:=y a:=b"],
    ),
    "timer": (
        ["TimerAction(period=2.5, actions=[Node(executable='late')])", "Node(executable='n')"],
        '<timer period="2.5"><node pkg="" exec="late"/></timer><node pkg="" exec="n"/>',
        "- timer:\n    period: 2.5\n    children:\n    - node: {pkg: '', exec: late}\n- node: {pkg: '', exec: n}",
        ["node /n /n", "node /late /late when timer 2.5"],
    ),
    "timer of ROS": (
        ["RosTimer(period=3.0, actions=[Node(executable='late')])"],
        '<ros_timer period="3.0"><node pkg="" exec="late"/></ros_timer>',
        "- ros_timer:\n    period: 3.0\n    children:\n    - node: {pkg: '', exec: late}",
        ["node /late /late when timer 3.0"],
    ),
    "container": (
        ["ComposableNodeContainer(name='c', namespace='', package='demo', executable='box', "
         "composable_node_descriptions=["
         "ComposableNode(package='demo', plugin='demo::Part', name='p', namespace='ns', remappings=[('x', 'y')])])"],
        '<node_container name="c" namespace="" pkg="demo" exec="box"><composable_node pkg="demo" plugin="demo::Part" '
        'name="p" namespace="ns"><remap from="x" to="y"/></composable_node></node_container>',
        "- node_container: {name: c, namespace: '', pkg: demo, exec: box, composable_node: "
        "[{pkg: demo, plugin: 'demo::Part', name: p, namespace: ns, remap: [{from: x, to: y}]}]}",
        ["container /c demo/box", "component /ns/p demo/demo::Part x:=y in /c"],
    ),
    "components for a container": (
        ["LoadComposableNodes(target_container='c', composable_node_descriptions=["
         "ComposableNode(package='demo', plugin='demo::Part', name='p')])",
         "Node(package='demo', executable='box', name='c')"],
        '<load_composable_node target="c"><composable_node pkg="demo" plugin="demo::Part" name="p"/>'
        '</load_composable_node><node pkg="demo" exec="box" name="c"/>',
        "- load_composable_node: {target: c, composable_node: [{pkg: demo, plugin: 'demo::Part', name: p}]}\n"
        "- node: {pkg: demo, exec: box, name: c}",
        ["component /p demo/demo::Part in /c", "node /c demo/box"],
    ),
    "loop": (
        ["ForLoop('2', function=lambda i: [Node(executable=f'n{i}')])"],
        '<for len="2" name="i"><node pkg="" exec="n$(index i)"/></for>',
        "- for:\n    len: 2\n    name: i\n    children:\n    - node: {pkg: '', exec: n$(index i)}",
        ["node /n0 /n0", "node /n1 /n1"],
    ),
    "loop over values": (
        ["ForEach('{name: a, id: 1}; {name: b, id: 2}', function=lambda name, id: [Node(executable=f'{name}{id}')])"],
        '<for_each values="{name: a, id: 1}; {name: b, id: 2}"><node pkg="" exec="$(for-var name)$(for-var id)"/>'
        "</for_each>",
        "- for_each:\n    values: '{name: a, id: 1}; {name: b, id: 2}'\n    children:\n"
        "    - node: {pkg: '', exec: $(for-var name)$(for-var id)}",
        ["node /a1 /a1", "node /b2 /b2"],
    ),
    "what starts nothing": (
        ["LogInfo(msg='a')", "LogDebug(msg='a')", "LogWarning(msg='a')", "LogError(msg='a')",
         "Log(msg='a', level='info')",
         "Shutdown(reason='r')", "SetROSLogDir('/l')", "SetUseSimTime(True)", "ResetLaunchConfigurations()",
         "LifecycleTransition(lifecycle_node_names=['a'], transition_ids=[1])"],
        '<log_info message="a"/><log_debug message="a"/><log_warning message="a"/><log_error message="a"/>'
        '<log message="a" level="INFO"/><shutdown reason="r"/><set_ros_log_dir new_log_dir="/l"/>'
        '<set_use_sim_time value="true"/><reset/><lifecycle_transition lifecycle_node_names="a" transition_ids="1"/>',
        "- log_info: {message: a}\n- log_debug: {message: a}\n- log_warning: {message: a}\n- log_error: {message: a}\n"
        "- log: {message: a, level: INFO}\n- shutdown: {reason: r}\n- set_ros_log_dir: {new_log_dir: /l}\n"
        "- set_use_sim_time: {value: true}\n- reset: {}\n"
        "- lifecycle_transition: {lifecycle_node_names: a, transition_ids: '1'}",
        [],
    ),
}  # fmt: skip
ONLY_PYTHON = {
    "opaque function": (
        ["DeclareLaunchArgument('n', default_value='2')", "OpaqueFunction(function=make, args=['p'])"],
        "def make(context, prefix):\n    count = int(LaunchConfiguration('n').perform(context))\n"
        "    return [Node(executable=f'{prefix}{i}') for i in range(count)]",
        ["node /p0 /p0", "node /p1 /p1"],
    ),
    "description inside": (["LaunchDescription([Node(executable='n')])"], "", ["node /n /n"]),
    "pushed configurations": (
        ["SetLaunchConfiguration('a', '1')", "PushLaunchConfigurations()", "SetLaunchConfiguration('a', '2')",
         "PopLaunchConfigurations()", "Node(executable=['n', LaunchConfiguration('a')])"],
        "",
        ["node /n1 /n1"],
    ),
    "pushed environment": (
        ["PushEnvironment()", "SetEnvironmentVariable('A', '2')", "PopEnvironment()", "Node(executable='n')"],
        "",
        ["node /n /n"],
    ),
    "configurations that are reset": (
        ["SetLaunchConfiguration('a', '1')", "ResetLaunchConfigurations({'b': '3'})",
         "Node(executable=[LaunchConfiguration('a', default='0'), LaunchConfiguration('b')])"],
        "",
        ["node /03 /03"],
    ),
    "end of a process": (
        ["RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[Node(executable='next')]))", "first"],
        "first = Node(executable='first', name='f')",
        ["node /f /first", "node /next /next when exit /f"],
    ),
    "start of a process": (
        ["first", "RegisterEventHandler(OnProcessStart(target_action=first, on_start=[Node(executable='next')]))"],
        "first = Node(executable='first', name='f')",
        ["node /f /first", "node /next /next when start /f"],
    ),
    "function of a handler on its end": (
        ["Node(executable='n', name='n', on_exit=[Node(executable='next')])"],
        "",
        ["node /n /n", "node /next /next when exit /n"],
    ),
    "state of a lifecycle node": (
        ["life", "RegisterEventHandler(OnStateTransition(target_lifecycle_node=life, goal_state='active',"
         " entities=[Node(executable='next')]))",
         "EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(life),"
         " transition_id=Transition.TRANSITION_CONFIGURE))"],
        "from lifecycle_msgs.msg import Transition\nfrom launch.events import matches_action\n"
        "from launch_ros.event_handlers import OnStateTransition\nfrom launch_ros.events.lifecycle import ChangeState\n"
        "life = LifecycleNode(executable='l', name='life', namespace='')",
        ["lifecycle /life /l", "node /next /next when state /life"],
    ),
    "shutdown": (
        ["RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg='bye')]))", "EmitEvent(event=Shutdown(reason='r'))"],
        "from launch.events import Shutdown",
        [],
    ),
    "component with its own condition": (
        ["ComposableNodeContainer(name='c', namespace='', package='demo', executable='box', "
         "composable_node_descriptions=["
         "ComposableNode(package='demo', plugin='A', condition=IfCondition('false')),"
         "ComposableNode(package='demo', plugin='B', name='b')])"],
        "",
        ["container /c demo/box", "component /b demo/B in /c"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_action_is_the_same_in_three_languages(case: tuple[list[str], str, str, list[str]]) -> None:
    in_python, in_xml, in_yaml, expected = case
    body = "".join(f"  {line}\n" for line in in_yaml.splitlines())
    assert describe_all(load_clean(python(*in_python), files=INCLUDED)) == expected
    assert describe_all(load_clean(xml(in_xml), "/ws/a.launch.xml", INCLUDED)) == expected
    assert describe_all(load_clean(f"launch:\n{body}", "/ws/a.launch.yaml", INCLUDED)) == expected


@pytest.mark.parametrize("case", ONLY_PYTHON.values(), ids=ONLY_PYTHON)
def test_action_of_python_becomes_a_plan(case: tuple[list[str], str, list[str]]) -> None:
    actions, before, expected = case
    assert describe_all(load_clean(python(*actions, before=before))) == expected


def test_details_of_a_process_are_kept() -> None:
    words = "cwd='/w', prefix='nice', respawn=True, "
    words += "respawn_delay=1.5, output='screen', on_exit=Shutdown(), emulate_tty=True"
    node = load_clean(python(f"Node(executable='n', {words})")).nodes[0]
    found = (node.cwd, node.launch_prefix, node.respawn, node.respawn_delay, node.output, node.required)
    assert found == ("/w", "nice", True, 1.5, "screen", True)
    written = 'cwd="/w" launch-prefix="nice" respawn="true" respawn_delay="1.5" output="screen" on_exit="shutdown"'
    again = load_clean(xml(f'<node pkg="" exec="n" {written}/>'), "/ws/a.launch.xml").nodes[0]
    assert (again.cwd, again.launch_prefix, again.respawn, again.respawn_delay, again.output, again.required) == found


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "a.launch.py",
            python(
                "LifecycleNode(package='demo', executable='life', name='n', namespace='a', autostart=True)",
                "LoadComposableNodes(target_container='c', composable_node_descriptions=[ComposableLifecycleNode("
                "package='demo', plugin='P', name='p', namespace='b', autostart=TextSubstitution(text='true'))])",
                "LifecycleNode(package='demo', executable='life', name='m', namespace='', autostart=False)",
                "Node(executable='box', name='c')",
            ),
        ),
        (
            "a.launch.xml",
            xml(
                '<lifecycle_node pkg="demo" exec="life" name="n" namespace="a" autostart="true"/>'
                '<load_composable_node target="c"><composable_lifecycle_node pkg="demo" plugin="P" name="p" '
                'namespace="b" autostart="$(not false)"/></load_composable_node>'
                '<lifecycle_node pkg="demo" exec="life" name="m" namespace="" autostart="false"/>'
                '<node pkg="" exec="box" name="c"/>'
            ),
        ),
    ],
)
def test_autostart_configures_and_activates_a_lifecycle_node(name: str, text: str) -> None:
    plan = load_clean(text, f"/ws/{name}")
    assert [node.full_name for node in plan.nodes] == ["/a/n", "/b/p", "/m", "/c"]
    found = [(action.kind, action.text, action.node, action.position) for action in plan.actions]
    assert found == [("state", "1 3", "/a/n", 1), ("state", "1 3", "/b/p", 2)]


def test_terminal_is_emulated_as_the_node_or_the_configuration_says() -> None:
    nodes = [f"Node(executable='n', emulate_tty={value})" for value in ("True", "False")]
    assert [node.emulates_terminal for node in load_clean(python(*nodes)).nodes] == [True, False]
    plan = load(python(*nodes), arguments=["emulate_tty:=false"])
    assert [node.emulates_terminal for node in plan.nodes] == [False, False]
    plan = load_clean(xml('<node pkg="" exec="n" emulate_tty="true"/>'), "/ws/a.launch.xml")
    assert plan.nodes[0].emulates_terminal


def test_program_with_a_shell_is_one_command_of_it() -> None:
    plan = load_clean(python("ExecuteProcess(cmd=[['a ', 'b'], 'c'], shell=True)"))
    assert (plan.nodes[0].type, plan.nodes[0].words) == ("sh", ("-c", "a b c"))


@pytest.mark.parametrize(
    ("action", "rule"),
    [
        ("Node(node_executable='n')", "launch-argument"),
        ("Node(executable='n', colour='red')", "launch-argument"),
        ("Node(executable='n', name='a/b')", "bad-name"),
        ("Node(executable='n', namespace='a b')", "bad-name"),
        ("Node(executable='n', parameters='a.yaml')", "launch-value"),
        ("Node(executable='n', remappings=['a'])", "launch-value"),
        ("Node(executable='n', parameters=['/no.yaml'])", "missing-file"),
        ("Node(executable='n', condition='true')", "launch-value"),
        ("IfCondition('true')", "launch-value"),
        ("[Node(executable='n')]", "launch-value"),
        ("IncludeLaunchDescription('/no.launch.py')", "missing-file"),
        ("IncludeLaunchDescription('/ws/a.launch.py')", "include-cycle"),
        ("TimerAction(period='soon', actions=[])", "bad-number"),
        ("RegisterEventHandler(Node(executable='n'))", "launch-value"),
        ("RegisterEventHandler(7)", "launch-value"),
        ("DeclareLaunchArgument('a')", "missing-argument"),
        ("DeclareLaunchArgument('a', default_value='c', choices=['a', 'b'])", "bad-choice"),
        ("Node(executable=LaunchConfiguration('nothing'))", "undeclared-argument"),
        ("Node(executable=FindPackageShare('nothing'))", "unknown-package"),
        ("Node(executable=EnvironmentVariable('NOTHING'))", "unset-variable"),
        ("Node(executable=nothing)", "undefined-name"),
        ("DeclareLaunchArgument('a', 'b')", "launch-argument"),
        ("SetRemap('a')", "launch-argument"),
    ],
)
def test_mistake_in_python_is_found_and_does_not_hide_what_follows(action: str, rule: str) -> None:
    plan = load(python(action, "Node(executable='follows')"))
    assert rules(plan)[:1] == [rule]
    assert all(found.span is not None for found in plan.diagnostics)
    if rule != "include-cycle":
        assert describe_all(plan)[-1].startswith("node /follows /follows")


@pytest.mark.parametrize(
    ("body", "rule"),
    [
        ('<node pkg="p" type="t"/>', "unknown-attribute"),
        ('<node pkg="p"/>', "missing-attribute"),
        ('<rosparam command="load"/>', "unknown-tag"),
        ('<nod pkg="p" exec="e"/>', "unknown-tag"),
        ('<node pkg="p" exec="e"><arg name="a"/></node>', "unknown-tag"),
        ('<node pkg="p" exec="e" if="1" unless="1"/>', "bad-condition"),
        ('<node pkg="p" exec="e" if="yes"/>', "bad-condition"),
        ('<node pkg="p" exec="$(find p)/x"/>', "bad-substitution"),
        ('<node pkg="p" exec="$(var a"/>', "bad-substitution"),
        ('<node pkg="p" exec="e" args="\'"/>', "launch-value"),
        ('<node pkg="p" exec="e" on_exit="restart"/>', "bad-choice"),
        ('<node pkg="p" exec="e"><param name="a"/></node>', "missing-attribute"),
        ('<executable cmd="a" name="b" pkg="c"/>', "unknown-attribute"),
    ],
)
def test_mistake_in_xml_is_found_and_does_not_hide_what_follows(body: str, rule: str) -> None:
    plan = load(xml(f'{body}<node pkg="" exec="follows"/>'), "/ws/a.launch.xml")
    assert rules(plan)[:1] == [rule]
    assert describe_all(plan)[-1] == "node /follows /follows"


@pytest.mark.parametrize(
    ("text", "name", "rule"),
    [
        ("def f(:\n", "/ws/a.launch.py", "python-syntax"),
        ("x = 1\n", "/ws/a.launch.py", "launch-function"),
        ("def generate_launch_description():\n    return 5\n", "/ws/a.launch.py", "launch-function"),
        ("a: [", "/ws/a.launch.yaml", "bad-yaml"),
        ("", "/ws/a.launch.yaml", "launch-element"),
        ("start:\n- node: {pkg: a, exec: b}\n", "/ws/a.launch.yaml", "launch-element"),
        ("<start/>", "/ws/a.launch.xml", "launch-element"),
        ("<launch>", "/ws/a.launch.xml", "bad-xml"),
    ],
)
def test_file_that_is_none_is_one_error(text: str, name: str, rule: str) -> None:
    plan = load(text, name)
    assert rules(plan) == [rule]
    assert not plan.nodes


def test_component_without_container_is_a_warning() -> None:
    loaded = "LoadComposableNodes(target_container='c', composable_node_descriptions=[{}])"
    component = "ComposableNode(package='demo', plugin='A', name='a')"
    box = "ComposableNodeContainer(name='{}', namespace='', package='demo', executable='box')"
    assert rules(load(python(box.format("other"), loaded.format(component)))) == ["unknown-container"]
    assert rules(load(python(loaded.format(component), box.format("c")))) == []


def test_two_nodes_of_one_name_are_a_warning() -> None:
    assert rules(load(python("Node(executable='a', name='n')", "Node(executable='b', name='n')"))) == ["duplicate-node"]
    assert rules(load(python("Node(executable='a')", "Node(executable='a')"))) == []


@pytest.mark.parametrize(
    ("arguments", "rule"), [(["b:=1"], "unknown-argument"), (["a:=u"], ""), (["a=1"], "bad-argument"), ([], "")]
)
def test_arguments_of_the_command_line_are_compared_with_those_declared(arguments: list[str], rule: str) -> None:
    plan = load(python("DeclareLaunchArgument('a', default_value='t')"), arguments=arguments)
    assert rules(plan) == ([rule] if rule else [])
