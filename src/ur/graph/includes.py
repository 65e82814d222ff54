"""The include tree of a plan: which file includes which, and which nodes each starts."""

from collections.abc import Iterator, Mapping, Sequence

from ur.graph.boxes import Arrow, Branch, DrawnGraph, GraphBox
from ur.launchfile.plan.specs import IncludeSpec, NodeSpec, Origin, Plan
from ur.source.file import Span

_Place = tuple[tuple[str, int], ...]  # the <include> tags that lead to a file


def build_trees(plan: Plan, files: Sequence[str]) -> tuple[Branch, ...]:
    """Return a tree for each launch file of a plan. `files` are absolute paths.

    A file that could not be read is `missing`; one that includes itself is drawn once more, as `cycle`, and ends there.
    """
    includes: dict[_Place, list[IncludeSpec]] = {}
    nodes: dict[_Place, list[NodeSpec]] = {}
    for include in plan.includes:
        includes.setdefault(_place(include.origin), []).append(include)
    for node in plan.nodes:
        nodes.setdefault(_place(node.origin), []).append(node)
    return tuple(_grow(path, (), (path,), includes, nodes) for path in files)


def _grow(
    path: str,
    place: _Place,
    above: tuple[str, ...],
    includes: Mapping[_Place, Sequence[IncludeSpec]],
    nodes: Mapping[_Place, Sequence[NodeSpec]],
) -> Branch:
    own = [each for each in includes.get(place, ()) if place or _same(each.origin.span, path)]
    parts = [(each.origin.span.start, _grow_include(each, place, above, includes, nodes)) for each in own]
    started = [each for each in nodes.get(place, ()) if place or _same(each.origin.span, path)]
    parts += [(each.origin.span.start, _node(each)) for each in started]
    parts.sort(key=lambda part: part[0])
    return Branch("file", path, _name(path), children=tuple(branch for _, branch in parts))


def _grow_include(
    include: IncludeSpec,
    place: _Place,
    above: tuple[str, ...],
    includes: Mapping[_Place, Sequence[IncludeSpec]],
    nodes: Mapping[_Place, Sequence[NodeSpec]],
) -> Branch:
    if not include.found:
        return Branch("missing", include.file, _name(include.file), f"no such file: {include.file}")
    if include.file in above:
        return Branch("cycle", include.file, _name(include.file), "includes itself")
    inside = (*place, _step(include.origin.span))
    return _grow(include.file, inside, (*above, include.file), includes, nodes)


def _node(node: NodeSpec) -> Branch:
    program = f"{node.package}/{node.type}".lstrip("/")
    where = f" on {node.machine}" if node.machine and node.machine != "localhost" else ""
    return Branch("node", node.full_name, node.full_name, program + where)


def merge_trees(trees: Sequence[Branch]) -> DrawnGraph:
    """Return the trees as one graph: a file that is included twice is one box."""
    boxes: dict[str, GraphBox] = {}
    arrows: dict[tuple[str, str], Arrow] = {}
    for tree in trees:
        for branch, parent in walk_tree(tree):
            kind = branch.kind if branch.kind != "cycle" else "file"
            boxes.setdefault(branch.key, GraphBox(f"b{len(boxes)}", branch.label, kind, branch.note or branch.key))
            if parent is not None:
                ends = boxes[parent.key].id, boxes[branch.key].id
                circle = branch.kind == "cycle"
                fault = circle or branch.kind == "missing"
                arrows.setdefault(ends, Arrow(*ends, "includes itself" if circle else "", fault=fault))
    return DrawnGraph(tuple(boxes.values()), tuple(arrows.values()))


def walk_tree(tree: Branch) -> Iterator[tuple[Branch, Branch | None]]:
    """Yield every branch with its parent, top down."""
    stack: list[tuple[Branch, Branch | None]] = [(tree, None)]
    while stack:
        branch, above = stack.pop()
        yield branch, above
        stack.extend((child, branch) for child in reversed(branch.children))


def _place(origin: Origin) -> _Place:
    return tuple(map(_step, origin.includes))


def _step(span: Span) -> tuple[str, int]:
    return span.file.path, span.start


def _same(span: Span, path: str) -> bool:
    return span.file.path == path or path.endswith("/" + span.file.path.removeprefix("./"))


def _name(path: str) -> str:
    return path.rpartition("/")[2]
