"""Which nodes of a plan start beside nodes that run already."""

from pathlib import Path

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.memory import MemoryWorld
from ur.run.join.decision import (
    Claims,
    Held,
    decide,
    define_nodes,
    find_free_names,
    find_localisers,
    find_misfits,
    leave_out,
    make_claims,
    read_claims,
    write_claims,
)

BASE = """<launch>
  <arg name="world" default="maze"/>
  <arg name="speed" default="1"/>
  <param name="description" value="of the robot"/>
  <node pkg="p" type="sim" name="simulator">
    <param name="world_file" value="/w/$(arg world).yaml"/>
    <param name="speed" value="$(arg speed)"/>
  </node>
</launch>"""
TASK = """<launch>
  <arg name="world" default="maze"/>
  <arg name="speed" default="1"/>
  <arg name="goal" default="1"/>
  <param name="shared" value="of the task"/>
  <include file="/r/m_robot_base/launch/m_robot_base.launch.xml" pass_all_args="true"/>
  <node pkg="p" type="map" name="map_server"><param name="file" value="$(arg world)"/></node>
  <node pkg="p" type="keys" name="keys"><!--terminal: it reads keys--><param name="goal" value="$(arg goal)"/></node>
</launch>"""
WORLD = MemoryWorld({"/r/m_robot_base/launch/m_robot_base.launch.xml": BASE, "/task.launch": TASK})


def plan_with(*arguments: str) -> Plan:
    return load_plan(["/task.launch"], arguments, WORLD)


def hold(plan: Plan, *names: str, run: str = "first.1") -> list[Held]:
    defined = define_nodes(plan.nodes, plan.params)
    return [Held(name, run, defined[name]) for name in names]


def names(held: tuple[Held, ...]) -> list[str]:
    return [each.name for each in held]


def test_base_is_joined_whatever_it_was_started_with() -> None:
    decision = decide(plan_with(), hold(plan_with("world:=office", "speed:=3"), "/simulator"))
    assert names(decision.base) == ["/simulator"]
    assert not decision.refused


def test_base_of_another_master_user_is_joined_without_its_definition() -> None:
    assert names(decide(plan_with(), [Held("/simulator")]).base) == ["/simulator"]


def test_other_node_is_used_only_when_it_is_defined_alike() -> None:
    assert names(decide(plan_with(), hold(plan_with(), "/map_server")).used) == ["/map_server"]
    other = decide(plan_with("world:=office"), hold(plan_with(), "/map_server"))
    assert (names(other.used), names(other.refused)) == ([], ["/map_server"])
    assert names(decide(plan_with(), [Held("/map_server")]).refused) == ["/map_server"]


def test_node_that_owns_the_terminal_is_started_under_a_free_name() -> None:
    decision = decide(plan_with(), hold(plan_with(), "/keys"))
    assert names(decision.renamed) == ["/keys"]
    assert find_free_names(["/keys"], ["/keys", "/keys_2", "/map_server"]) == {"/keys": "/keys_3"}


def test_plan_that_joins_a_base_sets_nothing_of_the_base_and_all_of_its_own() -> None:
    plan = plan_with("goal:=2")
    left = leave_out(plan, decide(plan, hold(plan, "/simulator")))
    assert [node.full_name for node in left.nodes] == ["/map_server", "/keys"]
    assert {each.name: each.value for each in left.params} == {
        "/shared": "of the task",
        "/map_server/file": "maze",
        "/keys/goal": 2,
    }


def test_plan_stays_whole_where_nothing_runs() -> None:
    plan = plan_with()
    assert leave_out(plan, decide(plan, [])) is plan


@pytest.mark.parametrize(
    ("given", "varied", "misfit"),
    [
        ("world:=maze", ["world:=maze0"], "param world_file"),  # the default, and yet not what runs
        ("speed:=2", ["speed:=1", "speed:=20"], "param speed"),
        ("world:=office", ["world:=maze", "world:=office0"], ""),  # as it runs
        ("goal:=7", ["goal:=1", "goal:=70"], ""),  # none of the base's
    ],
)
def test_argument_is_a_misfit_when_the_running_base_has_something_else(
    given: str, varied: list[str], misfit: str
) -> None:
    plan = plan_with(given)
    decision = decide(plan, hold(plan_with("world:=office", "speed:=3"), "/simulator"))
    found = find_misfits(plan, decision, {given: [plan_with(each) for each in varied]})
    assert [each.item for each in found] == ([misfit] if misfit else [])


def test_claims_are_read_as_they_were_written(tmp_path: Path) -> None:
    plan = plan_with()
    claims = make_claims(plan.nodes, plan.params, ["first.1"])
    assert claims.base == ("/simulator",)
    assert claims.nodes["/simulator"]["param world_file"] == "/w/maze.yaml"
    write_claims(str(tmp_path), claims)
    assert read_claims(str(tmp_path)) == claims


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"nodes": 3}', '{"nodes": {"a": 1}, "base": [], "joined": []}'])
def test_claims_that_cannot_be_read_are_empty(tmp_path: Path, text: str) -> None:
    (tmp_path / "claims.json").write_text(text)
    assert read_claims(str(tmp_path)) == Claims()


def test_localisers_are_known_by_program_and_frames_whatever_their_names() -> None:
    frames = '<param name="map_frame" value="/site"/><param name="odom_frame" value="{}"/>'
    nodes = [
        '<node pkg="nav2_amcl" type="amcl" name="where"/>',
        f'<node pkg="x" type="slam_gmapping" name="mapping">{frames.format("odom_2")}</node>',
        f'<node pkg="x" type="slam_gmapping" name="by_hand">{frames.format("")}</node>',
        '<node pkg="x" type="map_server" name="amcl"/>',
    ]
    plan = load_plan(["/l.launch"], [], MemoryWorld({"/l.launch": f"<launch>{''.join(nodes)}</launch>"}))
    assert find_localisers(define_nodes(plan.nodes, plan.params)) == {
        "/where": ("map", "odom"),
        "/mapping": ("site", "odom_2"),
        "/by_hand": ("site", "base_link"),
    }
