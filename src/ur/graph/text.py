"""Graphs as text, drawn for a terminal."""

from collections.abc import Iterator, Sequence

from ur.graph.boxes import Arrow, Branch, DrawnGraph, GraphBox
from ur.graph.topics import neighbours

Line = tuple[tuple[str, str], ...]  # pieces of a line: text, and the kind it is coloured as

_LINES = ("├─ ", "└─ ", "│  ", "   ", "→", "←")
_PLAIN = ("|- ", "`- ", "|  ", "   ", "->", "<-")


def draw_tree(tree: Branch, *, unicode: bool = True) -> Iterator[Line]:
    """Yield the lines of an include tree."""
    signs = _LINES if unicode else _PLAIN
    yield (tree.label, tree.kind), *_note(tree)
    yield from _draw_children(tree.children, "", signs)


def _draw_children(children: Sequence[Branch], lead: str, signs: Sequence[str]) -> Iterator[Line]:
    for child in children:
        last = child is children[-1]
        yield (lead + signs[1 if last else 0], "line"), (child.label, child.kind), *_note(child)
        yield from _draw_children(child.children, lead + signs[3 if last else 2], signs)


def _note(branch: Branch) -> Line:
    return (
        ((f"  {branch.note}", branch.kind if branch.kind in ("missing", "cycle") else "note"),) if branch.note else ()
    )


def draw_graph(graph: DrawnGraph, *, unicode: bool = True) -> Iterator[Line]:
    """Yield the nodes of a graph, each with its topics and nodes in both directions."""
    signs = _LINES if unicode else _PLAIN
    boxes = {box.id: box for box in graph.boxes}
    around = neighbours(graph)
    for box in sorted((box for box in graph.boxes if box.kind == "node"), key=lambda box: box.label):
        yield (box.label, "node"), *((((f"  {box.title}", "note"),)) if box.title != box.label else ())
        out, inward = around[box.id]
        for arrow in sorted(out, key=lambda arrow: boxes[arrow.target].label):
            ends = sorted(boxes[each.target].label for each in around[arrow.target][0])
            yield _connection(signs[4], boxes[arrow.target], ends, _certainty(arrow))
        for arrow in sorted(inward, key=lambda arrow: boxes[arrow.source].label):
            ends = sorted(boxes[each.source].label for each in around[arrow.source][1])
            yield _connection(signs[5], boxes[arrow.source], ends, "" if arrow.sure else _certainty(arrow))


def _certainty(arrow: Arrow) -> str:
    if arrow.sure:
        return arrow.label
    return f"(perhaps: {arrow.label})" if arrow.label else "(perhaps)"


def _connection(sign: str, middle: GraphBox, ends: Sequence[str], label: str) -> Line:
    pieces = [(f"  {sign} ", "line"), (middle.label, middle.kind)]
    if middle.kind != "topic":
        pieces.append((f" {middle.kind}", "note"))
    if label:
        pieces.append((f" {label}", "note"))
    if ends:
        pieces += [(f" {sign} ", "line"), (", ".join(ends), "node")]
    return tuple(pieces)
