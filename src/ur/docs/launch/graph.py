"""The graph of a launch file: its includes and nodes, over all cases, at least two arrows deep."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ur.docs.documents import BaseCase, TreeDoc, TreeItem
from ur.docs.words import name_cases
from ur.graph.boxes import Arrow, DrawnGraph, GraphBox, Kind

MAX_BOXES = 60


@dataclass(frozen=True, slots=True)
class _Edge:
    """An arrow between two boxes, by id. `label` is its condition.

    `new_cases` are the cases in which it exists, if those are fewer than its source box has.
    """

    source: str
    target: str
    label: str
    new_cases: tuple[BaseCase, ...]
    by_default: bool


def draw_graph(path: str, trees: Sequence[TreeDoc]) -> DrawnGraph:
    """Return boxes and arrows for the trees of a file.

    A repeated item is one box; a large graph shows files only. The title of a box is the path of its file.
    """
    whole = _Drawing(path, trees, with_nodes=True)
    if len(whole.boxes) <= MAX_BOXES:
        return whole.finish()
    files = _Drawing(path, trees, with_nodes=False)
    return files.finish()


class _Drawing:
    def __init__(self, path: str, trees: Sequence[TreeDoc], *, with_nodes: bool) -> None:
        self.path = path
        self.with_nodes = with_nodes
        self.boxes: dict[tuple[str, str], GraphBox] = {}
        self.edges: dict[tuple[str, str, str], dict[BaseCase, None]] = {}
        self.all_cases = [case for tree in trees for case in tree.cases]
        for tree in trees:
            top = self.box(tree.root)
            self.add(tree.root, top, tree.cases, set())

    def box(self, item: TreeItem, parent: str = "") -> GraphBox:
        # A node is a box per file that starts it; a file is one box wherever it is included.
        key = (item.kind, item.path or item.name) if item.kind != "node" else ("node", f"{parent} {item.name}")
        if key not in self.boxes:
            kind: Kind = "this" if item.kind == "file" and item.path == self.path else item.kind
            shown: Kind = "missing" if kind == "cycle" else kind
            name = item.path.rpartition("/")[2] if kind == "off" and item.path else item.name
            self.boxes[key] = GraphBox(f"b{len(self.boxes)}", name, shown, item.path)
        return self.boxes[key]

    def add(self, item: TreeItem, box: GraphBox, cases: tuple[BaseCase, ...], seen: set[int]) -> None:
        if id(item) in seen:
            return
        seen.add(id(item))
        for child in item.children:
            if child.kind == "node" and not self.with_nodes:
                continue
            target = self.box(child, box.id)
            arrow = self.edges.setdefault((box.id, target.id, child.note.replace("`", "")), {})
            arrow.update(dict.fromkeys(cases))
            self.add(child, target, cases, seen)

    def finish(self) -> DrawnGraph:
        boxes = list(self.boxes.values())
        reached: dict[str, set[BaseCase]] = {box.id: set() for box in boxes}
        reached[boxes[0].id].update(self.all_cases)
        for (_, target, _), where in self.edges.items():
            reached[target].update(where)
        kinds = {box.id: box.kind for box in boxes}
        cut = {box.id for box in boxes[:MAX_BOXES]}
        edges = [
            _Edge(
                source,
                target,
                label,
                () if cases.keys() >= reached[source] else tuple(cases),
                not label.startswith("only with") and kinds[target] != "off",
            )
            for (source, target, label), cases in self.edges.items()
            if source in cut and target in cut
        ]
        incoming: dict[str, list[_Edge]] = {}
        for edge in edges:
            incoming.setdefault(edge.target, []).append(edge)
        return DrawnGraph(
            tuple(_describe(box, incoming.get(box.id, [])) for box in boxes[:MAX_BOXES]),
            tuple(
                Arrow(
                    edge.source,
                    edge.target,
                    _join(edge.label, name_cases(edge.new_cases)),
                    edge.by_default,
                )
                for edge in edges
            ),
        )


def _describe(box: GraphBox, edges: Sequence[_Edge]) -> GraphBox:
    # The note of a box is the common part of all arrows to it.
    labels = {edge.label for edge in edges}
    new = dict.fromkeys(case for edge in edges for case in edge.new_cases)
    narrower = all(edge.new_cases for edge in edges)
    note = _join(labels.pop() if len(labels) == 1 else "", name_cases(new) if narrower else "")
    return replace(box, note=note)


def _join(*parts: str) -> str:
    return "; ".join(part for part in parts if part)
