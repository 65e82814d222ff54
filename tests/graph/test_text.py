"""The forms a graph is written in."""

from xml.etree import ElementTree

from ur.graph.boxes import Arrow, DrawnGraph, GraphBox
from ur.graph.svg import write_svg

GRAPH = DrawnGraph(
    (
        GraphBox("b0", 'a"<b>.launch', "file", "/p/a"),
        GraphBox("b1", "/talker", "node"),
        GraphBox("b2", "gone.launch", "missing"),
    ),
    (Arrow("b0", "b1"), Arrow("b0", "b2", "if & when", sure=False, fault=True), Arrow("b1", "b0")),
)


def test_svg_is_well_formed_and_holds_every_box_and_arrow() -> None:
    root = ElementTree.fromstring(write_svg(GRAPH, "a & b"))
    space = "{http://www.w3.org/2000/svg}"
    labels = [each.text for each in root.iter(f"{space}text")]
    assert {'a"<b>.launch', "/talker", "gone.launch", "if & when"} <= set(labels)
    arrows = [each.attrib["class"] for each in root.iter(f"{space}g") if "arrow" in each.get("class", "").split()]
    assert arrows == ["arrow", "arrow fault unsure", "arrow"]
    assert len([each for each in root.iter(f"{space}path") if each.get("class") == "tip"]) == len(arrows)
