from pathlib import Path

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import MachineSpec, Origin
from ur.launchfile.world.system import SystemWorld
from ur.run.startup.node_selection import keep_nodes, split_plan
from ur.source.file import SourceFile, Span

BODY = """<launch>
  <machine name="robot" address="robot.local" user="you"/>
  <machine name="again" address="robot.local" user="you"/>
  <machine name="other" address="robot.local" user="her"/>
  <machine name="desk" address="desk.local"/>
  <param name="p" value="1"/>
  <node pkg="a" type="a" name="one" machine="robot"/>
  <node pkg="a" type="a" name="two" machine="desk"/>
  <node pkg="a" type="a" name="three"/>
  <node pkg="a" type="a" name="four" machine="again"/>
  <node pkg="a" type="a" name="five" machine="other"/>
</launch>"""


def test_plan_is_split_by_computer_and_user_and_keeps_its_order(tmp_path: Path) -> None:
    path = tmp_path / "it.launch"
    path.write_text(BODY)
    plan = load_plan([str(path)], [], SystemWorld({}))
    asked: list[str] = []

    def is_here(address: str) -> bool:
        asked.append(address)
        return address == "desk.local"

    here, away = split_plan(plan, is_here)
    assert [node.name for node in here.nodes] == ["two", "three"]
    assert [(each.machine.name, [node.name for node in each.nodes]) for each in away] == [
        ("robot", ["one", "four"]),
        ("other", ["five"]),
    ]
    assert here.params == plan.params
    assert len(asked) >= 2


def test_plan_of_this_computer_alone_stays_whole(tmp_path: Path) -> None:
    path = tmp_path / "it.launch"
    path.write_text(BODY)
    plan = load_plan([str(path)], [], SystemWorld({}))
    assert split_plan(plan, lambda _: True) == (plan, ())


SHARED = """<launch>
  <param name="everyone" value="1"/>
  <group ns="base" clear_params="true">
    <node pkg="a" type="a" name="drive"><param name="speed" value="1"/></node>
    <node pkg="a" type="a" name="drive2" clear_params="true"><param name="speed" value="2"/></node>
  </group>
  <node pkg="a" type="a" name="keys" clear_params="true"><param name="layout" value="x"/></node>
</launch>"""


@pytest.mark.parametrize(
    ("names", "params", "cleared"),
    [
        ({"/keys"}, ["/everyone", "/keys/layout"], ["/keys"]),
        ({"/base/drive"}, ["/base/drive/speed", "/everyone"], []),
        (
            {"/base/drive", "/base/drive2"},
            ["/base/drive/speed", "/base/drive2/speed", "/everyone"],
            ["/base", "/base/drive2"],
        ),
        (set(), ["/everyone"], []),
    ],
)
def test_part_leaves_private_parameters_and_namespaces_of_the_others_alone(
    tmp_path: Path, names: set[str], params: list[str], cleared: list[str]
) -> None:
    path = tmp_path / "it.launch"
    path.write_text(SHARED)
    plan = load_plan([str(path)], [], SystemWorld({}))
    part = keep_nodes(plan, names)
    assert {node.full_name for node in part.nodes} == names
    assert sorted(each.name for each in part.params) == params
    assert sorted(space.rstrip("/") for space in part.clear_params) == cleared


def test_computer_needs_no_machine_tag_and_a_tag_goes_before_it(tmp_path: Path) -> None:
    path = tmp_path / "it.launch"
    path.write_text('<launch><node pkg="a" type="a" name="one" machine="bob"/></launch>')
    origin = Origin(Span(SourceFile("<test>", "bob"), 0, 3))
    bob = MachineSpec("bob", "bob.local", user=None, env_loader=None, ssh_port=22, timeout=10.0, origin=origin)
    world = SystemWorld({})
    assert [each.rule for each in load_plan([str(path)], [], world).diagnostics] == ["unknown-machine"]
    plan = load_plan([str(path)], [], world, computers=[bob])
    assert (plan.diagnostics, plan.machines) == ((), (bob,))
    path.write_text('<launch><machine name="bob" address="10.0.0.7"/></launch>')
    plan = load_plan([str(path)], [], world, computers=[bob])
    assert [machine.address for machine in plan.machines] == ["10.0.0.7"]
