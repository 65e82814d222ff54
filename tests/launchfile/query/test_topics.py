"""What launch files and the table of nodes tell of topics."""

from ur.launchfile.load import load_plan
from ur.launchfile.query.topics import NameUse, find_name_uses
from ur.launchfile.world.memory import MemoryWorld


def uses_of(node: str) -> list[tuple[str | None, str, str]]:
    plan = load_plan(["/a.launch"], [], MemoryWorld({"/a.launch": f"<launch>{node}</launch>"}))
    assert not plan.diagnostics
    return [(use.use, use.name, use.evidence) for use in find_name_uses(plan.nodes[0])]


def test_table_knows_upstream_nodes_and_remaps_apply() -> None:
    found = uses_of(
        '<group ns="r"><node name="n" pkg="amcl" type="amcl"><remap from="scan" to="front/scan"/></node></group>'
    )
    assert ("subscribes", "/r/front/scan", "table") in found
    assert ("publishes", "/r/amcl_pose", "table") in found
    assert ("publishes", "/tf", "table") in found
    assert ("offers-service", "/r/global_localization", "table") in found


def test_private_names_are_below_the_node() -> None:
    assert ("publishes", "/cam/image_raw", "table") in uses_of('<node name="cam" pkg="usb_cam" type="usb_cam_node"/>')


def test_ready_comment_comes_first_and_says_the_rate() -> None:
    node = '<node name="n" pkg="p" type="t"><!--ready: topic odom 20 Hz; action go; frame base; process--></node>'
    plan = load_plan(["/a.launch"], [], MemoryWorld({"/a.launch": f"<launch>{node}</launch>"}))
    assert find_name_uses(plan.nodes[0]) == (
        NameUse("/odom", "publishes", "ready", 20.0),
        NameUse("/go", "offers-action", "ready"),
        NameUse("base", "sends-frame", "ready"),
    )


def test_remap_of_an_unknown_node_tells_that_it_uses_the_name() -> None:
    found = uses_of('<node name="n" pkg="p" type="t"><remap from="in" to="out"/><remap from="~a" to="b"/></node>')
    assert found == [(None, "/out", "remap"), (None, "/b", "remap")]


def test_comments_tell_the_topics_of_an_unknown_node_and_remaps_apply() -> None:
    node = '<node name="n" pkg="p" type="t"><!--publishes: cmd_vel--><!--subscribes: scan ~in b-d--><remap {}/></node>'
    assert uses_of(node.format('from="cmd_vel" to="nav_vel"')) == [
        ("publishes", "/nav_vel", "comment"),
        ("subscribes", "/scan", "comment"),
        ("subscribes", "/n/in", "comment"),
    ]
