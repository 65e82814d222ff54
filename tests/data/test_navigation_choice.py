"""The argument `navigation` of m_keyboard_navigate: this project's navigation, or Nav2 that the user starts."""

from __future__ import annotations

from tests.base_contract import PACKAGE

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.system import SystemWorld

FILE = PACKAGE / "m_keyboard_navigate/launch/m_keyboard_navigate.launch.xml"
OWN = {"/map_server", "/amcl", "/move_base"}


def make_plan(*arguments: str) -> Plan:
    world = SystemWorld({"ROS_PACKAGE_PATH": str(PACKAGE), "HOME": "/home/me"})
    return load_plan([str(FILE)], ["robot_base:=stage", *arguments], world)


def names_of(plan: Plan) -> set[str]:
    return {node.full_name for node in plan.nodes}


def remaps_of(plan: Plan, name: str) -> dict[str, str]:
    return {source: target for node in plan.nodes if node.full_name == name for source, target in node.remaps}


def test_beside_nav2_no_navigation_of_ours_is_started_and_patrols_are() -> None:
    assert names_of(make_plan()) - names_of(make_plan("navigation:=nav2")) == OWN
    assert "/patrol" in names_of(make_plan("navigation:=nav2"))


def test_mux_is_between_nav2_and_the_base() -> None:
    plan = make_plan("navigation:=nav2")
    assert {each.name: each.value for each in plan.params}["/cmd_vel_mux/takes_over"] == "cmd_vel"
    assert remaps_of(plan, "/cmd_vel_mux") == {"cmd_vel_out": "cmd_vel_base"}
    assert remaps_of(plan, "/simulator") == {"cmd_vel": "cmd_vel_base"}
    assert remaps_of(make_plan(), "/simulator") == {}
