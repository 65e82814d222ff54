"""SVG output of graphs: boxes in layers from left to right with few crossings, as a separate file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise

from ur.graph.boxes import Arrow, DrawnGraph, GraphBox
from ur.source.printable import printable_lines

_SWEEPS = 8
_CHARACTER = 7.6  # px of an average character of the font
_PADDING = 22.0
HEIGHT = 30.0  # of a box
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
    sizes = {box.id: (len(box.label) * _CHARACTER + _PADDING, HEIGHT) for box in graph.boxes}
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


_MARGIN = 12.0
_STYLE = """\
<style>
  svg { background: #fff; font: 13px ui-monospace, "DejaVu Sans Mono", monospace; }
  rect { fill: #f4f6f8; stroke: #67717d; stroke-width: 1.2; } text { fill: #1b2026; }
  .node rect { fill: #e2f4ea; stroke: #1f8a55; } .topic rect { fill: #e6eefb; stroke: #4a6fb5; }
  .service rect, .action rect { fill: #f7efdc; stroke: #a37a1c; }
  .missing rect, .cycle rect { fill: #fde8e6; stroke: #c22; stroke-dasharray: 5 3; } .missing text { fill: #a11; }
  path { fill: none; stroke: #8b95a1; stroke-width: 1.2; } .tip { fill: #8b95a1; stroke: none; }
  .fault path { stroke: #c22; } .fault .tip { fill: #c22; stroke: none; } .unsure path { stroke-dasharray: 4 4; }
  .label { font-size: 11px; fill: #5b6570; }
  @media (prefers-color-scheme: dark) {
    svg { background: #14181d; } rect { fill: #20262d; stroke: #8a95a3; } text { fill: #e4e9ef; }
    .node rect { fill: #163626; stroke: #3fb27a; } .topic rect { fill: #1a2a47; stroke: #7fa2e6; }
    .service rect, .action rect { fill: #3a2f14; stroke: #d1a548; }
    .missing rect, .cycle rect { fill: #431b1a; stroke: #ff6b62; } .missing text { fill: #ff9c95; }
    .label { fill: #a5b0bd; }
  }
</style>
"""


def write_svg(graph: DrawnGraph, title: str) -> str:
    """Return a separate picture with `title` as its name; it follows the reader's light or dark scheme."""
    picture = lay_out_graph(graph)
    # Arrows that lead back dip below the boxes.
    dips = [_dip(picture.positions[arrow.source], picture.positions[arrow.target]) for arrow in graph.arrows]
    bottom = max([picture.height, *(0.75 * dip + 0.25 * picture.height for dip in dips if dip)])
    width, height = picture.width + 2 * _MARGIN, bottom + 2 * _MARGIN
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" viewBox="0 0 {width:.0f} {height:.0f}"'
        f' width="{width:.0f}" height="{height:.0f}" aria-label="{escape(title)}">\n',
        f"<title>{escape(title)}</title>\n{_STYLE}",
        f'<g transform="translate({_MARGIN:g} {_MARGIN:g})">\n',
    ]
    parts += [_draw_arrow(arrow, picture) for arrow in graph.arrows]
    parts += [_draw_box(box, picture.positions[box.id]) for box in graph.boxes]
    return printable_lines("".join([*parts, "</g>\n</svg>\n"]))


def _draw_box(box: GraphBox, position: BoxPosition) -> str:
    middle = position.x + position.width / 2
    return (
        f'<g class="{box.kind}"><title>{escape(box.title or box.label)}</title>'
        f'<rect x="{position.x:.1f}" y="{position.y:.1f}" width="{position.width:.1f}"'
        f' height="{position.height:g}" rx="6"/>'
        f'<text x="{middle:.1f}" y="{position.y + HEIGHT / 2 + 4.5:.1f}" text-anchor="middle">'
        f"{escape(box.label)}</text></g>\n"
    )


def _draw_arrow(arrow: Arrow, picture: GraphLayout) -> str:
    source, target = picture.positions[arrow.source], picture.positions[arrow.target]
    dip = _dip(source, target)
    if dip is None:
        points = [(source.x + source.width, source.y + source.height / 2)]
        points += picture.routes.get((arrow.source, arrow.target), ())
        points.append((target.x, target.y + target.height / 2))
        line = f"M{_at(points[0])}" + "".join(_bow(before, after) for before, after in pairwise(points))
        tip = "l-8 -4v8z"
    else:
        points = [(place.x + place.width / 2, place.y + place.height) for place in (source, target)]
        line = f"M{_at(points[0])}C{points[0][0]:.1f} {dip:.1f} {points[1][0]:.1f} {dip:.1f} {_at(points[1])}"
        tip = "l-4 8h8z"
    name = "".join(f" {word}" for word, on in (("fault", arrow.fault), ("unsure", not arrow.sure)) if on)
    text = ""
    if arrow.label:
        (x1, y1), (x2, y2) = points[0], points[-1]
        place = f'x="{(x1 + x2) / 2:.1f}" y="{(y1 + y2) / 2 - 4:.1f}"'
        text = f'<text class="label" {place} text-anchor="middle">{escape(arrow.label)}</text>'
    return f'<g class="arrow{name}"><path d="{line}"/><path class="tip" d="M{_at(points[-1])}{tip}"/>{text}</g>\n'


def _dip(source: BoxPosition, target: BoxPosition) -> float | None:
    """Return the lowest control point of an arrow that does not lead to the right; None for one that does."""
    return None if target.x > source.x else max(source.y + source.height, target.y + target.height) + 26


def _bow(before: tuple[float, float], after: tuple[float, float]) -> str:
    if before[1] == after[1]:
        return f"L{_at(after)}"
    bend = max((after[0] - before[0]) / 2, 20.0)
    return f"C{before[0] + bend:.1f} {before[1]:.1f} {after[0] - bend:.1f} {after[1]:.1f} {_at(after)}"


def _at(point: tuple[float, float]) -> str:
    return f"{point[0]:.1f} {point[1]:.1f}"
