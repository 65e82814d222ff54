"""The graph of a launch file: what it includes and starts, over all cases, two arrows deep at least."""

from __future__ import annotations

from collections.abc import Sequence

from ur.docs.model import Box, Case, Edge, GraphDoc, TreeDoc, TreeItem

MAX_BOXES = 60


def draw_graph(path: str, trees: Sequence[TreeDoc]) -> GraphDoc:
    """Boxes and arrows from the trees of a file. What occurs twice is one box; a large graph shows files only."""
    whole = _Drawing(path, trees, with_nodes=True)
    if len(whole.boxes) <= MAX_BOXES:
        return whole.finish()
    files = _Drawing(path, trees, with_nodes=False)
    return files.finish()


class _Drawing:
    def __init__(self, path: str, trees: Sequence[TreeDoc], *, with_nodes: bool) -> None:
        self.path = path
        self.with_nodes = with_nodes
        self.boxes: dict[tuple[str, str], Box] = {}
        self.edges: dict[tuple[str, str, str], dict[Case, None]] = {}
        self.all_cases = [case for tree in trees for case in tree.cases]
        for tree in trees:
            top = self.box(tree.root)
            self.add(tree.root, top, tree.cases, set())

    def box(self, item: TreeItem, parent: str = "") -> Box:
        # A node is a box per file that starts it; a file is one box wherever it is included.
        key = (item.kind, item.path or item.name) if item.kind != "node" else ("node", f"{parent} {item.name}")
        if key not in self.boxes:
            kind = "this" if item.kind == "file" and item.path == self.path else item.kind
            shown = "missing" if kind == "cycle" else kind
            name = item.path.rpartition("/")[2] if kind == "off" and item.path else item.name
            self.boxes[key] = Box(f"b{len(self.boxes)}", name, shown, item.path)
        return self.boxes[key]

    def add(self, item: TreeItem, box: Box, cases: tuple[Case, ...], seen: set[int]) -> None:
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

    def finish(self) -> GraphDoc:
        boxes = list(self.boxes.values())
        reached: dict[str, set[Case]] = {box.id: set() for box in boxes}
        reached[boxes[0].id].update(self.all_cases)
        for (_, target, _), where in self.edges.items():
            reached[target].update(where)
        kinds = {box.id: box.kind for box in boxes}
        cut = {box.id for box in boxes[:MAX_BOXES]}
        edges = (
            Edge(
                source,
                target,
                label,
                () if len(cases) == len(self.all_cases) else tuple(cases),
                () if cases.keys() >= reached[source] else tuple(cases),
                not label.startswith("only with") and kinds[target] != "off",
            )
            for (source, target, label), cases in self.edges.items()
            if source in cut and target in cut
        )
        return GraphDoc(tuple(boxes[:MAX_BOXES]), tuple(edges))
