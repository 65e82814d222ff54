"""Layout of a graph: boxes in layers from left to right, with few crossings.

The method is Sugiyama's in its simplest form: arrows that close a cycle are reversed, a box is one layer to the right
of the last one that points to it, an arrow that crosses a layer has a bend there, and layers are sorted by the mean
position of their neighbours, in both directions. (K. Sugiyama, S. Tagawa, M. Toda, IEEE Transactions on Systems, Man,
and Cybernetics 11(2), 1981.)
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from ur.graph.boxes import Arrow, DrawnGraph, GraphBox

_SWEEPS = 8
_CHARACTER = 7.6  # px of an average character of the font
_PADDING = 22.0
HEIGHT, TALL = 30.0, 46.0  # of a box with one line, and with a note below it
_NOTE = 0.85  # the size of a note's characters, over that of a label's
_GAP_X, _GAP_Y = 64.0, 16.0
_BEND = (0.0, 0.0)  # the size of a place where an arrow passes a layer


@dataclass(frozen=True, slots=True)
class BoxPosition:
    """Left, top, width and height of a box, in px."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class GraphLayout:
    """A layout in px: its size, the position of each box by id, and the bends of long arrows, by their ends."""

    width: float
    height: float
    positions: Mapping[str, BoxPosition]
    routes: Mapping[tuple[str, str], tuple[tuple[float, float], ...]]


def lay_out_graph(graph: DrawnGraph) -> GraphLayout:
    """Place the boxes. Deterministic; linear in boxes and arrows except for the sorting."""
    ids = [box.id for box in graph.boxes]
    sizes = {box.id: _measure(box) for box in graph.boxes}
    pairs = _break_circles(ids, graph.arrows)
    layers = _find_layers(ids, pairs)
    links, bends = _bend_long_arrows(layers, pairs)
    layers = _sort_layers(layers, links)
    places: dict[str, BoxPosition] = {}
    # A bend has no height, and goes straight through its layer.
    tall = max((sum(sizes.get(each, _BEND)[1] + _GAP_Y for each in layer) for layer in layers), default=_GAP_Y)
    x = 0.0
    for layer in layers:
        wide = max(sizes.get(each, _BEND)[0] for each in layer)
        y = (tall - sum(sizes.get(each, _BEND)[1] + _GAP_Y for each in layer)) / 2.0
        for each in layer:
            width, height = sizes.get(each, (wide, 0.0))
            places[each] = BoxPosition(x, y, width, height)
            y += height + _GAP_Y
        x += wide + _GAP_X
    routes = {
        ends: tuple(point for each in passed for point in _through(places.pop(each))) for ends, passed in bends.items()
    }
    return GraphLayout(max(x - _GAP_X, 0.0), tall - _GAP_Y, places, routes)


def _measure(box: GraphBox) -> tuple[float, float]:
    longest = max(len(box.label), _NOTE * len(box.note))
    return longest * _CHARACTER + _PADDING, TALL if box.note else HEIGHT


def _through(position: BoxPosition) -> tuple[tuple[float, float], tuple[float, float]]:
    return (position.x, position.y), (position.x + position.width, position.y)


def _bend_long_arrows(
    layers: list[list[str]], pairs: Sequence[tuple[str, str]]
) -> tuple[list[tuple[str, str]], dict[tuple[str, str], list[str]]]:
    """Add a bend to each layer that an arrow crosses; return arrows between adjacent layers, and the bends of each."""
    level = {each: number for number, layer in enumerate(layers) for each in layer}
    links: list[tuple[str, str]] = []
    bends: dict[tuple[str, str], list[str]] = {}
    for source, target in dict.fromkeys(pairs):
        passed = [f"{source}>{target}@{number}" for number in range(level[source] + 1, level[target])]
        for number, bend in enumerate(passed, level[source] + 1):
            layers[number].append(bend)
        if passed:
            bends[source, target] = passed
        links += pairwise((source, *passed, target))
    return links, bends


def _break_circles(ids: Sequence[str], arrows: Sequence[Arrow]) -> list[tuple[str, str]]:
    """Return the arrows as pairs, with those that close a cycle reversed."""
    after: dict[str, list[str]] = {each: [] for each in ids}
    for arrow in arrows:
        after[arrow.source].append(arrow.target)
    state: dict[str, int] = {}  # 1: being visited, 2: done
    pairs: list[tuple[str, str]] = []
    for start in ids:
        if start in state:
            continue
        state[start] = 1
        stack = [(start, iter(after[start]))]
        while stack:
            box, rest = stack[-1]
            target = next(rest, None)
            if target is None:
                state[box] = 2
                stack.pop()
            elif state.get(target) == 1:
                if target != box:
                    pairs.append((target, box))
            else:
                pairs.append((box, target))
                if target not in state:
                    state[target] = 1
                    stack.append((target, iter(after[target])))
    return pairs


def _find_layers(ids: Sequence[str], pairs: Sequence[tuple[str, str]]) -> list[list[str]]:
    before: dict[str, int] = dict.fromkeys(ids, 0)
    after: dict[str, list[str]] = {each: [] for each in ids}
    for source, target in pairs:
        before[target] += 1
        after[source].append(target)
    depth = dict.fromkeys(ids, 0)
    ready = [each for each in ids if not before[each]]
    for box in ready:  # it grows while it is walked
        for target in after[box]:
            depth[target] = max(depth[target], depth[box] + 1)
            before[target] -= 1
            if not before[target]:
                ready.append(target)
    layers: list[list[str]] = [[] for _ in range(max(depth.values(), default=-1) + 1)]
    for each in ids:
        layers[depth[each]].append(each)
    return layers


def _sort_layers(layers: list[list[str]], links: Sequence[tuple[str, str]]) -> list[list[str]]:
    around: dict[str, list[str]] = {each: [] for layer in layers for each in layer}
    for source, target in links:
        around[source].append(target)
        around[target].append(source)
    rank = {each: float(number) for layer in layers for number, each in enumerate(layer)}
    level = {each: number for number, layer in enumerate(layers) for each in layer}
    for sweep in range(_SWEEPS):
        step = 1 if sweep % 2 == 0 else -1
        for number in range(len(layers))[::step]:

            def mean(box: str, number: int = number, step: int = step) -> float:
                near = [rank[each] for each in around[box] if (level[each] - number) * step < 0]
                return sum(near) / len(near) if near else rank[box]

            layers[number] = sorted(layers[number], key=mean)
            middle = (len(layers[number]) - 1) / 2.0
            rank.update({each: place - middle for place, each in enumerate(layers[number])})
    return layers
