"""The drawn graph: inside its picture, no box over another."""

from __future__ import annotations

import itertools
import re
from xml.etree import ElementTree

from tests.docs.helpers import LIBRARY, ROVER, document_folder, find

from ur.docs.documents import BaseCase
from ur.docs.site.pages import draw_svg
from ur.graph.boxes import Arrow, DrawnGraph, GraphBox

_BOX = re.compile(r'<rect x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)"')


def boxes_of(svg: str) -> list[tuple[float, float, float, float]]:
    return [(float(x), float(y), float(width), float(height)) for x, y, width, height in _BOX.findall(svg)]


def test_boxes_lie_inside_and_never_over_one_another() -> None:
    for folder in (LIBRARY, ROVER):
        for package in document_folder(folder).packages:
            for doc in package.launch_files:
                svg = draw_svg(doc.graph, doc.name, lambda path: path)
                if not svg:
                    continue
                root = ElementTree.fromstring(svg)
                boxes = boxes_of(svg)
                assert len(boxes) == len(doc.graph.boxes)
                for x, y, width, height in boxes:
                    assert x + width <= float(root.attrib["width"])
                    assert y + height <= float(root.attrib["height"])
                for one, other in itertools.combinations(boxes, 2):
                    apart = one[0] + one[2] <= other[0] or other[0] + other[2] <= one[0]
                    assert apart or one[1] + one[3] <= other[1] or other[1] + other[3] <= one[1], (doc.path, one, other)


def test_circle_is_drawn() -> None:
    graph = DrawnGraph(
        (GraphBox("b0", "a", "this"), GraphBox("b1", "b", "file")), (Arrow("b0", "b1"), Arrow("b1", "b0"))
    )
    assert len(boxes_of(draw_svg(graph, "circle", lambda _path: None))) == 2


def test_graph_without_arrows_is_nothing() -> None:
    assert draw_svg(DrawnGraph((GraphBox("b0", "a", "this"),), ()), "", lambda _path: None) == ""


def test_arrows_carry_their_bases_for_the_switch() -> None:
    doc = find(document_folder(ROVER), "m_rover/launch/m_rover.launch.xml")
    svg = draw_svg(doc.graph, doc.name, lambda _path: None)
    assert 'data-cases="loki"' in svg
    assert f'data-cases="{BaseCase("magni", "arm").key}"' in svg
