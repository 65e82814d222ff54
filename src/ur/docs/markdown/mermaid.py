"""Graphs for GitHub: Mermaid."""

from __future__ import annotations

from collections.abc import Iterator

from ur.docs.model import Box, Edge, GraphDoc
from ur.docs.vary import name_cases

_SHAPES = {"node": ("(", ")"), "missing": ("{{", "}}"), "elsewhere": ("[/", "/]"), "unknown": ("[/", "/]")}
_STYLES = {
    "this": ("here", "stroke-width:3px"),
    "missing": ("gone", "stroke:#c00,color:#c00"),
    "elsewhere": ("other", "stroke-dasharray:4"),
}


def draw_mermaid(graph: GraphDoc) -> list[str]:
    """The lines of a Mermaid graph; none for a graph without arrows."""
    if not graph.edges:
        return []
    return ["graph LR", *(f"  {line}" for line in _lines(graph))]


def _lines(graph: GraphDoc) -> Iterator[str]:
    for box in graph.boxes:
        yield _draw_box(box)
    for edge in graph.edges:
        yield _draw_edge(edge)
    kinds = {box.kind for box in graph.boxes}
    for kind, (name, style) in _STYLES.items():
        if kind in kinds:
            yield f"classDef {name} {style}"


def _draw_box(box: Box) -> str:
    left, right = _SHAPES.get(box.kind, ("[", "]"))
    name = f":::{_STYLES[box.kind][0]}" if box.kind in _STYLES else ""
    return f'{box.id}{left}"{_quote(box.label)}"{right}{name}'


def _draw_edge(edge: Edge) -> str:
    label = "; ".join(part for part in (edge.label, name_cases(edge.new_cases)) if part)
    arrow = "-->" if edge.by_default else "-.->"
    return (
        f'{edge.source} {arrow}|"{_quote(label)}"| {edge.target}' if label else f"{edge.source} {arrow} {edge.target}"
    )


def _quote(text: str) -> str:
    return text.replace("&", "#amp;").replace('"', "#quot;").replace("<", "#lt;").replace(">", "#gt;")
