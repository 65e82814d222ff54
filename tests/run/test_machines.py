from __future__ import annotations

from pathlib import Path

from ur.launchfile.plan.load import load_plan
from ur.launchfile.world.system import SystemWorld
from ur.run.machines import split_plan

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
