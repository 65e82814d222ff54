"""Nodes and what they talk over: of a plan, without starting it, or of what a master knows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ur.graph.base_topics import find_base_uses
from ur.graph.model import Arrow, Box, Graph, Kind
from ur.launchfile.plan.model import NodeSpec, ParamValue, Plan
from ur.launchfile.query.topics import NameUse, find_name_uses

# What every ROS node has; it would hide everything else.
_COMMON_TOPICS = frozenset({"/rosout", "/rosout_agg"})
_TRANSFORMS = frozenset({"/tf", "/tf_static"})
_COMMON_NODES = frozenset({"/rosout"})


class _Builder:
    def __init__(self) -> None:
        self.boxes: dict[tuple[Kind, str], Box] = {}
        self.arrows: dict[tuple[str, str], Arrow] = {}

    def box(self, kind: Kind, name: str, title: str = "") -> str:
        found = self.boxes.setdefault((kind, name), Box(f"b{len(self.boxes)}", name, kind, title or name))
        return found.id

    def arrow(self, source: str, target: str, label: str = "", *, sure: bool = True) -> None:
        self.arrows.setdefault((source, target), Arrow(source, target, label, sure))

    def graph(self) -> Graph:
        return Graph(tuple(self.boxes.values()), tuple(self.arrows.values()))


def graph_plan(plan: Plan) -> Graph:
    """Graph of the topics, services and actions that the nodes of a plan are known to use.

    Known from `ready:` comments, the table of well-known nodes, the parameters and base of ours, and remaps: of other
    nodes only the box is there.
    """
    builder = _Builder()
    params = {param.name: param.value for param in plan.params}
    for node in plan.nodes:
        own = builder.box("node", node.full_name, f"{node.package}/{node.type}")
        for use in _find_uses(node, params):
            _connect(builder, own, use)
    return builder.graph()


def _find_uses(node: NodeSpec, params: Mapping[str, ParamValue]) -> Iterable[NameUse]:
    based = find_base_uses(node, params)
    yield from based
    names = {use.name for use in based}
    for use in find_name_uses(node):
        # The base and the parameters tell more than the table does.
        told = use.evidence == "table" and use.use in ("publishes", "subscribes") and use.name not in _TRANSFORMS
        if not based or not (told or (use.use is None and use.name in names)):
            yield use


def _connect(builder: _Builder, node: str, use: NameUse) -> None:
    label = f"{use.rate:g} Hz" if use.rate else use.doubt
    sure = not use.doubt
    match use.use:
        case "publishes":
            builder.arrow(node, builder.box("topic", use.name), label, sure=sure)
        case "subscribes":
            builder.arrow(builder.box("topic", use.name), node, label, sure=sure)
        case "offers-service" | "offers-action":
            builder.arrow(node, builder.box("service" if use.use == "offers-service" else "action", use.name))
        case "calls-service" | "uses-action":
            builder.arrow(builder.box("service" if use.use == "calls-service" else "action", use.name), node)
        case None:
            builder.arrow(node, builder.box("topic", use.name), label, sure=False)
        case _:  # frames are no names that two nodes share
            return


def graph_system(state: Sequence[Iterable[tuple[str, Sequence[str]]]], only: Iterable[str] = ()) -> Graph:
    """Graph of the nodes and topics of a master: `state` is the result of `getSystemState`.

    `only`: the nodes whose neighbourhood is wanted; without any, all. Services that every node has are left out.
    """
    builder = _Builder()
    publishers, subscribers = (dict(each) for each in state[:2])
    for topic, nodes in sorted(publishers.items()):
        if topic not in _COMMON_TOPICS:
            for node in sorted(set(nodes) - _COMMON_NODES):
                builder.arrow(builder.box("node", node), builder.box("topic", topic))
    for topic, nodes in sorted(subscribers.items()):
        if topic not in _COMMON_TOPICS:
            for node in sorted(set(nodes) - _COMMON_NODES):
                builder.arrow(builder.box("topic", topic), builder.box("node", node))
    wanted = frozenset(only)
    return _around(builder.graph(), wanted) if wanted else builder.graph()


def _around(graph: Graph, nodes: frozenset[str]) -> Graph:
    # The nodes, their topics, and who else speaks there.
    own = {box.id for box in graph.boxes if box.label in nodes}
    topics = {end for each in graph.arrows for end in (each.source, each.target) if {each.source, each.target} & own}
    kept = own | topics | {end for each in graph.arrows for end in _ends(each) if set(_ends(each)) & (topics - own)}
    arrows = tuple(each for each in graph.arrows if set(_ends(each)) & (topics - own))
    return Graph(tuple(box for box in graph.boxes if box.id in kept), arrows)


def _ends(arrow: Arrow) -> tuple[str, str]:
    return arrow.source, arrow.target


def neighbours(graph: Graph) -> Mapping[str, tuple[list[Arrow], list[Arrow]]]:
    """By id of a box: the arrows that leave it, and those that come in."""
    found: dict[str, tuple[list[Arrow], list[Arrow]]] = {box.id: ([], []) for box in graph.boxes}
    for arrow in graph.arrows:
        found[arrow.source][0].append(arrow)
        found[arrow.target][1].append(arrow)
    return found
