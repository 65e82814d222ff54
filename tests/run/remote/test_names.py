from collections.abc import Sequence
from typing import Any

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world import MemoryWorld
from ur.run.master.client import Master
from ur.run.remote.names import choose_names, find_taken, is_same_master, rename_nodes
from ur.run.remote.signs import Sign

LAUNCH = """\
<launch>
  <node ns="cam" name="view" pkg="p" type="t" clear_params="true">
    <param name="size" value="3"/>
    <remap from="~in" to="/keys/out"/>
    <!--ready: topic ~image-->
  </node>
  <node name="keys" pkg="p" type="t"/>
  <param name="keysight" value="1"/>
</launch>
"""


def plan_of(text: str) -> Plan:
    return load_plan(["/a.launch"], [], MemoryWorld(files={"/a.launch": text.encode()}))


def test_node_gets_another_name_with_all_that_is_private_to_it() -> None:
    plan = rename_nodes(plan_of(LAUNCH), {"/cam/view": "/cam/view_desk", "/keys": "/keys_desk"})
    view, keys = plan.nodes
    assert (view.full_name, view.name, keys.full_name) == ("/cam/view_desk", "view_desk", "/keys_desk")
    assert {each.name for each in plan.params} == {"/cam/view_desk/size", "/keysight"}
    assert plan.clear_params == ("/cam/view_desk/",)
    assert [each.name for each in view.ready] == ["/cam/view_desk/image"]
    assert view.remaps == (("~in", "/keys_desk/out"),)


def test_plan_stays_the_same_where_no_name_is_taken() -> None:
    plan = plan_of(LAUNCH)
    assert rename_nodes(plan, {}) is plan


@pytest.mark.parametrize(
    ("taken", "chosen"),
    [
        (set[str](), {}),
        ({"/keys"}, {"/keys": "/keys_desk_top"}),
        ({"/keys", "/keys_desk_top"}, {"/keys": "/keys_desk_top_2"}),
    ],
)
def test_name_of_the_computer_is_appended_where_a_name_is_taken(taken: set[str], chosen: dict[str, str]) -> None:
    assert choose_names(["/keys", "/view"], "desk-top.local", taken.intersection) == chosen


def test_only_live_nodes_of_other_computers_count() -> None:
    addresses: dict[str, object] = {
        "/here": "http://desk:1/",
        "/dead": "http://far:2/",
        "/live": "http://far:3/",
        "/odd": "rosrpc://far:4",
        "/none": RuntimeError("unknown"),
    }

    class Known(Master):
        def call_many(self, calls: Sequence[tuple[str, tuple[object, ...]]]) -> list[Any]:
            return [addresses[str(name)] for _, (name,) in calls]

    master = Known("http://bob:1", "bob", 1)
    probe = {"http://far:2/": Sign.ENDED, "http://far:3/": Sign.PRESENT}.get
    found = find_taken(list(addresses), master, lambda host: host == "desk", probe)  # type: ignore[arg-type]
    assert found == {"/live"}


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("http://bob.local:11311", "http://bob.local:11311/", True),
        ("http://localhost:11311", "http://127.0.0.1:11311", True),
        ("http://localhost:11311", "http://localhost:11312", False),
        ("http://localhost:11311", "http://bob.local:11311", False),
        ("nonsense", "nonsense", False),
    ],
)
def test_masters_are_compared_by_host_and_port(one: str, other: str, same: bool) -> None:
    assert is_same_master(one, other) is same
