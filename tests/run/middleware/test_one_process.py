"""One process as the middleware of a run, where no ROS is installed."""

import json
import os
import socket
from pathlib import Path

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world import World
from ur.launchfile.world.memory import MemoryWorld
from ur.run.launch import find_middleware, fork_command, register
from ur.run.master.parameters import start_commands
from ur.run.middleware.facts import read_facts
from ur.run.middleware.one_process import ProcessMiddleware, refuse_second_run
from ur.run.options import RunOptions
from ur.run.output.console import Console
from ur.run.process.command import find_programs
from ur.run.supervisor.events import ParametersSet, SetupFailed
from ur.source.diagnostic import UserError
from ur.source.project import launch_library
from ur.system.ros import NONE, graph_address, read_domain

PLAN = Plan((), (), (), (), (), ())
HEAD = '<launch><param name="robot_description" value="URDF"/><group ns="bob">'
STATE = '<node name="a" pkg="p" type="robot_state_publisher" args="x y"><remap from="scan" to="~s"/>'
STATE += '<env name="COLOUR" value="red"/></node>'
KEYS = '<node name="keys" pkg="p" type="teleop_twist_keyboard.py"/><!--terminal: true-->'


def make_environment(folder: Path) -> dict[str, str]:
    (folder / "run").mkdir(mode=0o700)
    (folder / "log").mkdir()
    return {"HOME": str(folder), "PATH": os.environ["PATH"], "ROS_VERSION": "0", "XDG_RUNTIME_DIR": f"{folder}/run"}


def make_world(text: str) -> World:
    library = launch_library()
    programs = {
        "/p/robot_state_publisher": str(library / "n_robot_state_publisher/bin/robot_state_publisher"),
        "/p/other": "/bin/true",
    }
    return OwnWorld({"/a.launch": text}, programs)


class OwnWorld(MemoryWorld):
    """Files in memory, with executables of this project."""

    def __init__(self, files: dict[str, str], programs: dict[str, str]) -> None:
        super().__init__(files)
        self._programs = programs

    def find_executables(self, package: str, name: str) -> tuple[str, ...]:
        return (self._programs[f"/{package}/{name}"],)


def make(folder: Path) -> ProcessMiddleware:
    found = find_middleware(PLAN, make_environment(folder), MemoryWorld({}), RunOptions(), Console())
    assert isinstance(found, ProcessMiddleware)
    return found


def load(text: str) -> tuple[Plan, World]:
    world = make_world(text)
    return load_plan(["/a.launch"], [], world), world


def test_nodes_of_a_plan_are_one_program_with_all_that_they_need(tmp_path: Path) -> None:
    middleware, (plan, world) = make(tmp_path), load(f"{HEAD}{STATE}</group></launch>")
    programs, problems = find_programs(plan.nodes, world)
    assert not problems
    (program,) = middleware.arrange(programs, plan.nodes, f"{tmp_path}/log")
    assert program.unit.name == "/nodes"
    assert program.argv[1:] == ("-I", "-m", "ur_nodes", "ur_nodes.one_process.host", f"{tmp_path}/log/nodes.json")
    assert dict(program.changes) == {"COLOUR": "red"}
    written = json.loads((tmp_path / "log/nodes.json").read_text())
    assert written["nodes"][0]["name"] == "/bob/a"
    assert written["nodes"][0]["words"] == ["ur_nodes.frames.robot_state_publisher_node", "x", "y"]
    assert written["nodes"][0]["remaps"] == {"/bob/scan": "/bob/a/s"}
    assert written["viewers"] == f"{tmp_path}/run/ubiquity_launches/nodes.sock"


def test_parameters_are_those_of_all_nodes_and_facts_those_of_the_run(tmp_path: Path) -> None:
    middleware, (plan, _world) = make(tmp_path), load(f"{HEAD}{STATE}</group></launch>")
    done = middleware.set_parameters(plan, f"{tmp_path}/log", RunOptions(base="magni"), start_commands((), {}))
    assert isinstance(done, ParametersSet)
    written = json.loads((tmp_path / "log/parameters.json").read_text())
    assert written == {"/robot_description": "URDF", "/bob/a/robot_description": "URDF"}
    assert read_facts(middleware.facts) == {"run_id": "log", "base_name": "magni", "variant": ""}


def test_simulated_time_is_refused(tmp_path: Path) -> None:
    middleware = make(tmp_path)
    plan, _world = load('<launch><param name="use_sim_time" value="true"/></launch>')
    failed = middleware.set_parameters(plan, f"{tmp_path}/log", RunOptions(), start_commands((), {}))
    assert isinstance(failed, SetupFailed)
    assert "simulated time needs ROS" in failed.reason


@pytest.mark.parametrize(
    ("node", "reason"),
    [
        ('type="other"', "/a: /bin/true is a program of its own"),
        (
            'type="robot_state_publisher" launch-prefix="nice"',
            "launch-prefix 'nice' needs a process of its own",
        ),
    ],
)
def test_node_that_can_only_be_a_process_of_its_own_is_refused(tmp_path: Path, node: str, reason: str) -> None:
    middleware, (plan, world) = make(tmp_path), load(f'<launch><node name="a" pkg="p" {node}/></launch>')
    programs, _ = find_programs(plan.nodes, world)
    with pytest.raises(UserError, match=reason):
        middleware.arrange(programs, plan.nodes, f"{tmp_path}/log")


def test_second_run_is_refused_while_one_is_under_way(tmp_path: Path) -> None:
    environment = make_environment(tmp_path)
    refuse_second_run(environment)
    plan, _world = load("<launch/>")
    entry, listener = register(plan, graph_address(environment), str(tmp_path), environment, Console(), detached=False)
    refuse_second_run(environment)  # it is this one
    with pytest.raises(UserError, match=f"run {entry.run} is under way: without ROS"):
        refuse_second_run(environment, own=os.getpid() + 1)
    assert isinstance(listener, socket.socket)
    listener.close()


def test_runs_meet_at_an_address_of_their_own() -> None:
    assert read_domain(graph_address({"ROS_VERSION": "0"})) == NONE


@pytest.mark.parametrize(
    ("node", "forked"),
    [
        ("", True),
        ('<env name="UR_MAP_FILE" value="m"/>', True),
        ('<env name="LD_PRELOAD" value="l"/>', False),
        ("<!--terminal: true-->", False),
    ],
)
def test_node_is_forked_unless_its_interpreter_differs(node: str, forked: bool) -> None:
    plan, world = load(f'<launch><node name="a" pkg="p" type="robot_state_publisher">{node}</node></launch>')
    (program,), _ = find_programs(plan.nodes, world)
    assert program.module == (("ur_nodes.frames.robot_state_publisher_node",) if forked else ())


def test_node_with_a_prefix_and_program_of_others_is_executed() -> None:
    text = '<node name="a" pkg="p" type="robot_state_publisher" launch-prefix="nice"/>'
    text += '<node name="b" pkg="p" type="other"/>'
    plan, world = load(f"<launch>{text}</launch>")
    programs, _ = find_programs(plan.nodes, world)
    assert [program.module for program in programs] == [(), ()]


def test_nodes_are_forked_from_two_on_and_without_a_debugger() -> None:
    text = "".join(f'<node name="{name}" pkg="p" type="robot_state_publisher"/>' for name in "ab")
    plan, world = load(f"<launch>{text}</launch>")
    programs, _ = find_programs(plan.nodes, world)
    module = "ur_nodes.frames.robot_state_publisher_node"
    assert fork_command(programs, {}, "/run")[1:] == ("ur_nodes.fork_server", "/run", module)
    assert fork_command(programs, {}, "")[1:] == ("ur_nodes.fork_server", "", module)
    assert fork_command(programs[:1], {}, "") == fork_command(programs, {"UR_NODE_PYTHON_OPTIONS": "-m pdb"}, "") == ()
