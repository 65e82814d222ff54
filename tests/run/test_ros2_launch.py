"""`ur launch` of files for ROS 2: processes with upstream's arguments, and what events cause. Nothing is left."""

import signal
import sys
from pathlib import Path
from typing import Any

import pytest
from tests.ros2_session import PYTHON, ROOT
from tests.run.ros2_world import Ros2World

HEAD = """
from launch import LaunchDescription
from launch.actions import *
from launch.event_handlers import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.descriptions import *
def node(name, *words, **more):
    return Node(package='demo', executable='show', name=name, arguments=list(words), **more)
def generate_launch_description():
    return LaunchDescription(make())
def make():
"""
LANGUAGES = {
    "a.launch.py": HEAD
    + """
    return [
        DeclareLaunchArgument('rate', default_value='5'),
        SetEnvironmentVariable('MINE', 'yes'),
        UnsetEnvironmentVariable('LESS'),
        node('one', 'x', 'y z', parameters=[{'rate': ParameterValue(LaunchConfiguration('rate'))}],
             remappings=[('a', 'b')], ros_arguments=['--log-level', 'warn']),
        GroupAction([
            PushRosNamespace('robot'), SetParameter('use_sim_time', True), SetRemap('/tf', 'tf'),
            node('two', namespace='deep', output='screen', parameters=[{'l': ParameterValue([1, 2])}]),
        ]),
        ExecuteProcess(cmd=['show', 'plain'], additional_env={'OWN': '1'}),
    ]
""",
    "a.launch.xml": """<launch>
      <arg name="rate" default="5"/>
      <set_env name="MINE" value="yes"/>
      <unset_env name="LESS"/>
      <node pkg="demo" exec="show" name="one" args="x 'y z'" ros_args="--log-level warn">
        <param name="rate" value="$(var rate)"/><remap from="a" to="b"/>
      </node>
      <group>
        <push_ros_namespace namespace="robot"/><set_parameter name="use_sim_time" value="true"/>
        <set_remap from="/tf" to="tf"/>
        <node pkg="demo" exec="show" name="two" namespace="deep" output="screen"><param name="l" value="[1, 2]"/></node>
      </group>
      <executable cmd="show plain"><env name="OWN" value="1"/></executable>
    </launch>""",
    "a.launch.yaml": """
launch:
- arg: {name: rate, default: "5"}
- set_env: {name: MINE, value: "yes"}
- unset_env: {name: LESS}
- node: {pkg: demo, exec: show, name: one, args: "x 'y z'", ros_args: --log-level warn,
         param: [{name: rate, value: $(var rate)}], remap: [{from: a, to: b}]}
- group:
  - push_ros_namespace: {namespace: robot}
  - set_parameter: {name: use_sim_time, value: "true"}
  - set_remap: {from: /tf, to: tf}
  - node: {pkg: demo, exec: show, name: two, namespace: deep, output: screen, param: [{name: l, value: [1, 2]}]}
- executable: {cmd: show plain, env: [{name: OWN, value: "1"}]}
""",
}


@pytest.fixture
def ros2(world: Any) -> Ros2World:
    made = Ros2World(world)
    world.environment["PATH"] = f"{made.folder}/prefix/lib/demo:{world.environment['PATH']}"
    return made


def start(ros2: Ros2World, body: str, *words: str) -> Any:
    """Start a Python file that returns actions."""
    return ros2.world.ur("launch", "--plain", ros2.write("b.launch.py", HEAD + body), *words)


def stop(run: Any, code: int = 0) -> None:
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == code, run.text
    run.wait_nothing_left()


@pytest.mark.parametrize("name", LANGUAGES)
def test_nodes_get_the_arguments_that_upstream_makes(ros2: Ros2World, name: str) -> None:
    ros2.write(name, LANGUAGES[name])
    run = ros2.world.ur("launch", "--plain", "demo", name, "rate:=7")
    run.until("shown --ros-args", "[/one] started", "[/show] started")
    ros2.until_shown(run, 3)
    stop(run)
    rate = "/**:\n  ros__parameters:\n    rate: 7\n"
    listed = "/robot/deep/two:\n  ros__parameters:\n    l:\n    - 1\n    - 2\n"
    two = ["--ros-args", "-r", "__node:=two", "-r", "__ns:=/robot/deep", "-p", "use_sim_time:=True"]
    one = ["x", "y z", "--ros-args", "--log-level", "warn", "--ros-args", "-r", "__node:=one", "--params-file", rate]
    assert ros2.argv() == [[*two, "--params-file", listed, "-r", "/tf:=tf"], ["plain"], [*one, "-r", "a:=b"]]
    found = {value["argv"][0]: value for value in ros2.found()}
    assert {value["cwd"] for value in found.values()} == {str(ros2.folder)}
    assert found["x"]["environment"] == {"MINE": "yes", "LESS": None, "OWN": None}
    assert found["plain"]["environment"] == {"MINE": "yes", "LESS": None, "OWN": "1"}


def test_values_of_the_other_kinds_are_written_as_upstream_writes_them(ros2: Ros2World) -> None:
    ros2.write("p.yaml", "/**: {ros__parameters: {home: '$(env LESS)'}}\n")
    run = start(
        ros2,
        f"""
    return [
        SetParametersFromFile('{ros2.share}/launch/p.yaml'), SetParameter('l', [1, 2]),
        Node(package='demo', executable='show', prefix='env MINE=prefix', cwd='/', output='screen', parameters=[
            {{'a': [1.5, 2], 'deep': {{'b': 'text', 'c': [True]}}}}, Parameter('r', 'x'),
            ParameterFile('{ros2.share}/launch/p.yaml', allow_substs=True)]),
    ]
""",
    )
    run.until("shown --ros-args")
    stop(run)
    shared = ["--params-file", "/**: {ros__parameters: {home: '$(env LESS)'}}\n", "-p", "l:=(1, 2)"]
    text = "/**:\n  ros__parameters:\n    a: !!python/tuple\n    - 1.5\n    - 2.0\n    deep.b: text\n"
    text += "    deep.c: !!python/tuple\n    - true\n"
    filled = ["--params-file", "/**: {ros__parameters: {home: 'x'}}\n"]
    assert ros2.argv() == [["--ros-args", *shared, "--params-file", text, "-p", "r:=x\n...\n", *filled]]
    assert (ros2.found()[0]["cwd"], ros2.found()[0]["environment"]["MINE"]) == ("/", "prefix")


def test_events_have_effects_in_the_order_of_upstream(ros2: Ros2World) -> None:
    run = start(
        ros2,
        """
    first = node('first', 'exit:3', on_exit=[LogInfo(msg='registered first')])
    return [
        LogInfo(msg='hello'), first,
        RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[
            LogInfo(msg='registered last'), node('after', 'after'),
            TimerAction(period=0.1, actions=[node('late', 'late', 'exit:0', on_exit=[Shutdown()])])])),
        RegisterEventHandler(OnProcessStart(target_action=first, on_start=[node('beside', 'beside')])),
        RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg='bye')])),
    ]
""",
    )
    assert run.wait() == 0, run.text
    run.wait_nothing_left()
    lines = ["hello", "registered last", "registered first", "bye"]
    assert [line for line in run.text.splitlines() if line in lines] == lines
    assert "stopping: /late is required and has ended" in run.text
    names = [argv[0] for argv in (value["argv"] for value in ros2.found())]
    assert sorted(names) == ["after", "beside", "exit:3", "late"]
    assert run.text.index("[/after] started") < run.text.index("[/late] started")


def test_second_node_of_a_name_is_started_restarted_and_stopped(ros2: Ros2World) -> None:
    run = start(ros2, "    return [node('n', 'a'), node('n', 'b', 'exit:1', respawn=True, respawn_max_retries=1)]\n")
    run.until("[/n] started", "/n-2 died: exit code 1, starts again", "error: /n-2 died: exit code 1\n")
    name = ros2.world.call("ps").splitlines()[1].split()[0]
    assert name.startswith("b_launch_py.")
    assert "shown b" in ros2.world.call("logs", "/n-2")
    ros2.world.call("stop", name)
    assert run.wait() == 0, run.text
    run.wait_nothing_left()
    assert [argv[:1] for argv in ros2.argv()] == [["a"], ["b"], ["b"]]


def test_parts_that_are_not_known_are_refused_before_anything_starts(ros2: Ros2World) -> None:
    run = start(ros2, "    return [node('n'), node('m', LocalSubstitution('event'))]\n")
    assert run.wait() == 1
    assert "'ur launch' does not know this part of the launch file: local values" in run.text
    assert "b.launch.py:13:" in run.text
    assert "ur launch -- ros2 launch" in run.text
    assert ros2.found() == []


def test_commands_are_run_when_the_file_is_started_and_never_before(ros2: Ros2World) -> None:
    body = "    return [node('n', Command(f'touch {0}/ran'), Command('echo out'), output='screen')]\n"
    body = body.replace("f'touch {0}/ran'", f"'touch {ros2.folder}/ran'")
    path = ros2.write("c.launch.py", HEAD + body)
    assert "not known: it is the output of 'echo out'" in ros2.world.call("launch", "--dry-run", path)
    assert not (ros2.folder / "ran").exists()
    run = start(ros2, body)
    run.until("shown")
    stop(run)
    assert ros2.argv()[0][:2] == ["", "out\n"]
    failed = start(ros2, "    return [node('n', Command('cat /nowhere'))]\n")
    assert failed.wait() == 1
    assert "'cat /nowhere' ended with exit code 1, expected a value: cat: /nowhere" in failed.text


def test_nothing_is_left_when_the_supervisor_is_killed(ros2: Ros2World) -> None:
    run = start(ros2, "    return [node(f'n{i}', output='screen') for i in range(5)]\n")
    ros2.until_shown(run, 5)
    run.look()
    run.process.send_signal(signal.SIGKILL)
    run.wait()
    run.wait_nothing_left()


def test_program_of_a_source_package_runs_without_being_built(ros2: Ros2World) -> None:
    package = ros2.folder / "src/mine"
    for each in (package / "launch", package / "mine"):
        each.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>mine</name></package>")
    (package / "setup.py").write_text("setup(entry_points={'console_scripts': ['other=a:b', 'talk = mine.talk:main']})")
    (package / "mine/talk.py").write_text("import sys\ndef main():\n    print('talks', *sys.argv[1:])\n    return 3\n")
    action = "    return [Node(package='mine', executable='talk', name='t', output='screen', arguments=['a'])]\n"
    (package / "launch/mine.launch.py").write_text(HEAD + action)
    run = ros2.world.ur("launch", "--plain", str(package / "launch/mine.launch.py"))
    assert run.wait() == 0, run.text
    assert "talks a --ros-args -r __node:=t" in run.text
    (package / "setup.py").write_text("")
    run = ros2.world.ur("launch", "--plain", str(package / "launch/mine.launch.py"))
    assert run.wait() == 1
    assert "package 'mine' is not installed" in run.text


def test_commands_of_the_page_start_and_stop_a_file(ros2: Ros2World) -> None:
    page = (ROOT / "docs/how-to/ros2-launch-files.md").read_text(encoding="utf-8")
    block = page.partition("## Start it")[2].partition("```bash\n")[2].partition("```")[0]
    first, *others = [line.partition("#")[0].split()[1:] for line in block.splitlines()]
    share = ros2.share.with_name(first[1])
    (share / "launch").mkdir(parents=True)
    (share / "package.xml").write_text(f"<package><name>{first[1]}</name></package>")
    body = "    return [node('rplidar_composition', output='screen')]\n"
    (share / "launch" / first[2]).write_text(HEAD + body)
    run = ros2.world.ur(*first)
    run.until("shown")
    printed = [ros2.world.call(*words) for words in others]
    assert "standard_launch_py." in printed[0]
    assert "shown" in printed[1]
    assert run.wait() == 0, run.text
    run.wait_nothing_left()


def test_file_for_ros2_is_refused_where_ros1_is_selected(ros2: Ros2World) -> None:
    ros2.world.environment |= {"UR_ROBOT": "sim --ros none"}
    run = ros2.world.ur("launch", "--plain", ros2.write("a.launch.py", LANGUAGES["a.launch.py"]))
    assert run.wait() == 1
    assert "this is a launch file for ROS 2" in run.text
    assert "ur use sim --ros 2" in run.text


@pytest.mark.skipif(not PYTHON.exists(), reason="no wheels of ROS 2 for this processor")
def test_file_for_ros2_starts_with_it_where_ros1_is_only_the_default(ros2: Ros2World) -> None:
    ros2.world.environment |= {"UR_ROBOT": "sim", "ROS_VERSION": "1"}
    path = ros2.write("a.launch.py", HEAD + "    return [node('one', 'exit:0')]\n")
    run = ros2.world.ur("launch", "--plain", path)
    assert run.wait() == 0, run.text
    assert f"{path} is a launch file for ROS 2: using ROS 2" in run.text
    assert ros2.argv() == [["exit:0", "--ros-args", "-r", "__node:=one"]]


@pytest.mark.skipif(not PYTHON.exists(), reason="no wheels of ROS 2 for this processor")
@pytest.mark.parametrize("option", ["--dry-run", "--show-args", "--dump-params"])
def test_question_about_a_file_for_ros2_finds_its_packages_where_ros1_is_the_default(
    ros2: Ros2World, option: str
) -> None:
    ros2.world.environment |= {"UR_ROBOT": "sim", "ROS_VERSION": "1"}
    body = """
    from ament_index_python.packages import get_package_share_directory
    return [
        DeclareLaunchArgument('place', default_value=get_package_share_directory('std_msgs')),
        node('one', parameters=[{'place': LaunchConfiguration('place')}]),
    ]
"""
    ros2.write("q.launch.py", HEAD + body)
    run = ros2.world.ur("launch", option, "demo", "q.launch.py")
    assert run.wait() == 0, run.text
    assert "demo q.launch.py is a launch file for ROS 2: using ROS 2" in run.text
    assert f"{ROOT}/.ros2/share/std_msgs" in run.text


@pytest.mark.parametrize("output", ["screen", "log"])
def test_emulated_terminal_is_what_a_process_writes_to(ros2: Ros2World, output: str) -> None:
    program = "import sys; print('terminal', *(each.isatty() for each in (sys.stdin, sys.stdout, sys.stderr)))"
    run = start(
        ros2,
        f"""
    words = ['{sys.executable}', '-c', {program!r}]
    more = {{'cmd': words, 'output': '{output}'}}
    return [ExecuteProcess(name=f'p{{given}}', emulate_tty=given, **more) for given in (True, False)]
""",
    )
    assert run.wait() == 0, run.text
    logs = {path.name[:5]: path.read_text() for path in ros2.folder.rglob("p*-stdout.log")}
    assert logs == {"pTrue": "terminal False True True\n", "pFals": "terminal False False False\n"}
    assert ("terminal False True True" in run.text) == (output == "screen")


def test_event_handler_that_another_event_unregisters_causes_nothing_more(ros2: Ros2World) -> None:
    run = start(
        ros2,
        """
    first, second = node('first', 'exit:0'), node('second', 'exit:0')
    handler = OnProcessExit(target_action=second, on_exit=[node('wrong', 'wrong')])
    return [
        RegisterEventHandler(handler), first,
        RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[UnregisterEventHandler(handler), second])),
    ]
""",
    )
    assert run.wait() == 0, run.text
    assert [argv[0] for argv in ros2.argv()] == ["exit:0", "exit:0"]


def test_written_file_and_log_folder_reach_whatever_names_them(ros2: Ros2World) -> None:
    ros2.write("p.yaml", "/**: {ros__parameters: {rate: 5}}\n")
    body = f"""
    import os, tempfile
    path = tempfile.mktemp(suffix='.txt')
    with open(path, 'w') as file:
        file.write('written: true\\n')
    inner = tempfile.mkdtemp()
    with open(os.path.join(inner, 'a.yaml'), 'w') as file:
        file.write('beside: ' + path)
    new = RewrittenYaml(source_file='{ros2.share}/launch/p.yaml', param_rewrites={{'rate': '7'}})
    return [
        SetEnvironmentVariable('MINE', [inner, '/a.yaml']),
        node('one', path, new, ['file://', path], Command(['cat ', path]), LaunchLogDir(), remappings=[('a', path)],
             parameters=[{{'file': path}}]),
        LogInfo(msg=['logs are in ', LaunchLogDir()]),
    ]
"""
    run = start(ros2, "    from nav2_common.launch import RewrittenYaml" + body)
    ros2.until_shown(run, 1)
    stop(run)
    (found,) = ros2.found()
    log = next(path for path in ros2.folder.rglob("one-1-stdout.log")).parent
    path = found["argv"][0]
    assert path.startswith(f"{log}/written/")
    rewritten = "/**:\n  ros__parameters:\n    rate: '7'\n"
    assert found["argv"][1:5] == [rewritten, f"file://{path}", "written: true\n", str(log)]
    assert Path(path).read_text() == "written: true\n"
    assert found["argv"][-2:] == ["-r", f"a:={path}"]
    assert f"file: {path}" in found["argv"][-3]
    assert Path(found["environment"]["MINE"]).read_text() == f"beside: {path}"
    assert f"logs are in {log}" in run.text
