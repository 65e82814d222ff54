"""Nodes and topics, of a plan and of a master."""

from ur.graph.boxes import DrawnGraph
from ur.graph.text import draw_graph
from ur.graph.topics import graph_plan, graph_system
from ur.launchfile.load import load_plan
from ur.launchfile.world.memory import MemoryWorld

LAUNCH = """<launch>
  <node name="driver" pkg="mine" type="driver.py"><!--ready: topic scan 5 Hz--></node>
  <node name="amcl" pkg="amcl" type="amcl"><remap from="map" to="/floor/map"/></node>
  <node name="other" pkg="mine" type="other"><remap from="in" to="sound"/></node>
</launch>"""
STATE = (
    [("/scan", ["/driver"]), ("/rosout", ["/driver", "/amcl"]), ("/pose", ["/amcl"]), ("/log", ["/far"])],
    [("/scan", ["/amcl"]), ("/pose", ["/view"]), ("/rosout", ["/rosout"]), ("/log", ["/farther"])],
    [("/driver/get_loggers", ["/driver"])],
)


def arrows(graph: DrawnGraph) -> set[tuple[str, str]]:
    labels = {box.id: box.label for box in graph.boxes}
    return {(labels[arrow.source], labels[arrow.target]) for arrow in graph.arrows}


def test_plan_shows_what_ready_comments_the_table_and_remaps_tell() -> None:
    graph = graph_plan(load_plan(["/a.launch"], [], MemoryWorld({"/a.launch": LAUNCH})))
    found = arrows(graph)
    assert {("/driver", "/scan"), ("/scan", "/amcl"), ("/floor/map", "/amcl"), ("/amcl", "/tf")} <= found
    assert ("/other", "/sound") in found
    assert [arrow.label for arrow in graph.arrows if arrow.label and arrow.sure] == ["5 Hz"]
    lines = ["".join(piece for piece, _ in line) for line in draw_graph(graph)]
    assert "  → /sound (perhaps: in is remapped; the node may publish or subscribe it)" in lines
    assert sum(not arrow.sure for arrow in graph.arrows) == 1


def test_system_shows_topics_without_those_that_every_node_has() -> None:
    assert arrows(graph_system(STATE)) == {
        ("/driver", "/scan"), ("/scan", "/amcl"), ("/amcl", "/pose"), ("/pose", "/view"),
        ("/far", "/log"), ("/log", "/farther"),
    }  # fmt: skip


def test_system_around_a_node_shows_its_topics_and_who_speaks_there() -> None:
    graph = graph_system(STATE, ["/amcl"])
    assert arrows(graph) == {("/driver", "/scan"), ("/scan", "/amcl"), ("/amcl", "/pose"), ("/pose", "/view")}
    assert {box.label for box in graph.boxes} == {"/driver", "/scan", "/amcl", "/pose", "/view"}


def test_drawing_says_for_each_node_what_goes_where() -> None:
    lines = ["".join(piece for piece, _ in line) for line in draw_graph(graph_system(STATE, ["/amcl"]))]
    assert lines == [
        "/amcl",
        "  → /pose → /view",
        "  ← /scan ← /driver",
        "/driver",
        "  → /scan → /amcl",
        "/view",
        "  ← /pose ← /amcl",
    ]
