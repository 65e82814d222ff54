"""The graph of a launch file as inline SVG, with links to the pages of its files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ur.graph.model import Box, Graph
from ur.graph.svg import draw_inline

_LONG = 46


def draw_svg(graph: Graph, label: str, link_of: Callable[[str], str | None]) -> str:
    """The graph as an `<svg>`; nothing for one without arrows. `link_of`: the page of a path, None for no link."""
    boxes = tuple(_link(box, link_of) for box in graph.boxes)
    # What an arrow says stands in the box that it leads to.
    arrows = tuple(replace(arrow, label="") for arrow in graph.arrows)
    return draw_inline(Graph(boxes, arrows), label)


def _link(box: Box, link_of: Callable[[str], str | None]) -> Box:
    link = link_of(box.title) if box.title and box.kind != "this" else None
    return replace(box, label=_cut(box.label), note=_cut(box.note), title=box.title or box.label, link=link or "")


def _cut(text: str) -> str:
    return text if len(text) <= _LONG else text[: _LONG - 1] + "…"
