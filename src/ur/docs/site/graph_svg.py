"""Draws the graph of a launch file as inline SVG: columns from left to right, no library, no network."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from html import escape

from ur.docs.model import Box, Case, Edge, GraphDoc
from ur.docs.vary import name_cases

CHARACTER, PADDING, HEIGHT, TALL = 7.9, 12, 30, 44
COLUMN_GAP, ROW_GAP, MARGIN = 48, 12, 8
_LONG = 46


@dataclass(frozen=True, slots=True)
class _Placed:
    box: Box
    note: str
    cases: tuple[Case, ...]
    x: float
    y: float
    width: float
    height: float


def draw_svg(graph: GraphDoc, label: str, link_of: Callable[[str], str | None]) -> str:
    """The graph as an `<svg>`; nothing for one without arrows. `link_of`: the page of a path, None for no link."""
    if not graph.edges:
        return ""
    placed = _place(graph)
    width = max(each.x + each.width for each in placed.values()) + MARGIN
    height = max(each.y + each.height for each in placed.values()) + MARGIN
    parts = [_draw_edge(edge, placed) for edge in graph.edges]
    parts += [_draw_box(each, link_of) for each in placed.values()]
    return (
        f'<svg class="graph" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" height="{height:.0f}" '
        f'role="group" aria-label="{escape(label)}">{"".join(parts)}</svg>'
    )


def _place(graph: GraphDoc) -> dict[str, _Placed]:
    columns = _assign_columns(graph)
    incoming: dict[str, list[Edge]] = {}
    for edge in graph.edges:
        incoming.setdefault(edge.target, []).append(edge)
    order = {box.id: float(number) for number, box in enumerate(graph.boxes)}
    placed: dict[str, _Placed] = {}
    x = float(MARGIN)
    for column in range(max(columns.values()) + 1):
        boxes = [box for box in graph.boxes if columns[box.id] == column]
        boxes.sort(key=lambda box: (_mean(placed, incoming.get(box.id, [])), order[box.id]))
        widest, y = 0.0, float(MARGIN)
        for box in boxes:
            note, cases = _describe(incoming.get(box.id, []))
            text = max(len(_cut(box.label)), len(_cut(note)) * 0.85)
            width = text * CHARACTER + 2 * PADDING
            height = TALL if note else HEIGHT
            y = max(y, _mean(placed, incoming.get(box.id, [])) - height / 2)
            placed[box.id] = _Placed(box, note, cases, x, y, width, height)
            y += height + ROW_GAP
            widest = max(widest, width)
        x += widest + COLUMN_GAP
    return placed


def _assign_columns(graph: GraphDoc) -> dict[str, int]:
    # The longest way from the root; an arrow that leads back is not followed.
    following: dict[str, list[str]] = {}
    for edge in graph.edges:
        following.setdefault(edge.source, []).append(edge.target)
    columns = {box.id: 0 for box in graph.boxes}
    finished: list[str] = []
    state: dict[str, int] = {}
    back: set[tuple[str, str]] = set()
    stack = [(graph.boxes[0].id, iter(following.get(graph.boxes[0].id, ())))]
    state[graph.boxes[0].id] = 1
    while stack:
        box, rest = stack[-1]
        target = next(rest, None)
        if target is None:
            state[box] = 2
            finished.append(box)
            stack.pop()
        elif state.get(target) == 1:
            back.add((box, target))
        elif target not in state:
            state[target] = 1
            stack.append((target, iter(following.get(target, ()))))
    for box in reversed(finished):
        for target in following.get(box, ()):
            if (box, target) not in back:
                columns[target] = max(columns[target], columns[box] + 1)
    return columns


def _mean(placed: dict[str, _Placed], edges: list[Edge]) -> float:
    middles = [placed[e.source].y + placed[e.source].height / 2 for e in edges if e.source in placed]
    return sum(middles) / len(middles) if middles else 0.0


def _describe(edges: list[Edge]) -> tuple[str, tuple[Case, ...]]:
    # What all arrows to a box say stands in the box.
    labels = {edge.label for edge in edges}
    cases = dict.fromkeys(case for edge in edges for case in edge.cases)
    whole = any(not edge.cases for edge in edges)
    new = dict.fromkeys(case for edge in edges for case in edge.new_cases)
    narrower = all(edge.new_cases for edge in edges)
    parts = [labels.pop() if len(labels) == 1 else "", name_cases(new) if narrower else ""]
    return "; ".join(part for part in parts if part), () if whole else tuple(cases)


def _draw_box(placed: _Placed, link_of: Callable[[str], str | None]) -> str:
    box = placed.box
    round_ = 15 if box.kind == "node" else 4
    rows = [f'<text x="{PADDING}" y="20">{escape(_cut(box.label))}</text>']
    if placed.note:
        rows.append(f'<text class="note" x="{PADDING}" y="36">{escape(_cut(placed.note))}</text>')
    title = f"<title>{escape(', '.join(part for part in (box.label, placed.note) if part))}</title>"
    body = (
        f'<g class="box {box.kind}" transform="translate({placed.x:.0f} {placed.y:.0f})"{_cases(placed.cases)}>{title}'
        f'<rect width="{placed.width:.0f}" height="{placed.height}" rx="{round_}"/>{"".join(rows)}</g>'
    )
    target = link_of(box.path) if box.path and box.kind != "this" else None
    return f'<a href="{escape(target)}">{body}</a>' if target else body


def _draw_edge(edge: Edge, placed: dict[str, _Placed]) -> str:
    source, target = placed[edge.source], placed[edge.target]
    x1, y1 = source.x + source.width, source.y + source.height / 2
    x2, y2 = target.x, target.y + target.height / 2
    bend = max(24.0, (x2 - x1) / 2)
    off = "" if edge.by_default else " off"
    points = " ".join(f"{value:.0f}" for value in (x1 + bend, y1, x2 - bend, y2, x2 - 5, y2))
    tip = f"M{x2 - 6:.0f} {y2 - 4:.0f}L{x2:.0f} {y2:.0f}L{x2 - 6:.0f} {y2 + 4:.0f}Z"
    return (
        f'<g class="edge{off}"{_cases(edge.cases)}><path d="M{x1:.0f} {y1:.0f}C{points}"/>'
        f'<path class="tip" d="{tip}"/></g>'
    )


def _cases(cases: tuple[Case, ...]) -> str:
    keys = " ".join(_keys(cases))
    return f' data-cases="{escape(keys)}"' if keys else ""


def _keys(cases: tuple[Case, ...]) -> Iterator[str]:
    return (case.key for case in cases if case.base)


def _cut(text: str) -> str:
    return text if len(text) <= _LONG else text[: _LONG - 1] + "…"
