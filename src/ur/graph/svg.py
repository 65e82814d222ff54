"""A graph as SVG that follows the reader's light or dark scheme."""

from __future__ import annotations

from html import escape
from itertools import pairwise

from ur.graph.layout import HEIGHT, Picture, Place, lay_out_graph
from ur.graph.model import Arrow, Box, Graph
from ur.source.printable import printable_lines

_MARGIN = 12.0
_STYLE = """\
<style>
  svg { background: #fff; font: 13px ui-monospace, "DejaVu Sans Mono", monospace; }
  rect { fill: #f4f6f8; stroke: #67717d; stroke-width: 1.2; } text { fill: #1b2026; }
  .node rect { fill: #e2f4ea; stroke: #1f8a55; } .topic rect { fill: #e6eefb; stroke: #4a6fb5; }
  .service rect, .action rect { fill: #f7efdc; stroke: #a37a1c; }
  .missing rect, .cycle rect { fill: #fde8e6; stroke: #c22; stroke-dasharray: 5 3; } .missing text { fill: #a11; }
  path { fill: none; stroke: #8b95a1; stroke-width: 1.2; } path.fault { stroke: #c22; }
  path.unsure { stroke-dasharray: 4 4; } marker path { fill: #8b95a1; stroke: none; }
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


def write_svg(graph: Graph, title: str) -> str:
    """A picture of its own, with `title` as its name."""
    picture = lay_out_graph(graph)
    width, height = picture.width + 2 * _MARGIN, picture.height + 2 * _MARGIN
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}"'
        f' width="{width:.0f}" height="{height:.0f}" role="img" aria-label="{escape(title)}">\n',
        f"<title>{escape(title)}</title>\n{_STYLE}",
        '<defs><marker id="end" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="8" markerHeight="8" orient="auto">'
        '<path d="M0 0 8 4 0 8z"/></marker></defs>\n',
        f'<g transform="translate({_MARGIN:g} {_MARGIN:g})">\n',
    ]
    parts += [_draw_arrow(arrow, picture) for arrow in graph.arrows]
    parts += [_draw_box(box, picture.places[box.id]) for box in graph.boxes]
    return printable_lines("".join([*parts, "</g>\n</svg>\n"]))


def _draw_box(box: Box, place: Place) -> str:
    label = escape(box.label)
    return (
        f'<g class="{box.kind}"><title>{escape(box.title or box.label)}</title>'
        f'<rect x="{place.x:.1f}" y="{place.y:.1f}" width="{place.width:.1f}" height="{HEIGHT:g}" rx="6"/>'
        f'<text x="{place.x + place.width / 2:.1f}" y="{place.y + HEIGHT / 2 + 4.5:.1f}" text-anchor="middle">'
        f"{label}</text></g>\n"
    )


def _draw_arrow(arrow: Arrow, picture: Picture) -> str:
    source, target = picture.places[arrow.source], picture.places[arrow.target]
    if target.x > source.x:
        points = [(source.x + source.width, source.y + HEIGHT / 2)]
        points += picture.routes.get((arrow.source, arrow.target), ())
        points.append((target.x - 1, target.y + HEIGHT / 2))
        line = f"M{_at(points[0])}" + "".join(_bow(before, after) for before, after in pairwise(points))
    else:
        points = [(source.x + source.width / 2, source.y + HEIGHT), (target.x + target.width / 2, target.y + HEIGHT)]
        dip = max(source.y, target.y) + HEIGHT + 26
        line = f"M{_at(points[0])}C{points[0][0]:.1f} {dip:.1f} {points[1][0]:.1f} {dip:.1f} {_at(points[1])}"
    name = " ".join(word for word, on in (("fault", arrow.fault), ("unsure", not arrow.sure)) if on)
    style = f' class="{name}"' if name else ""
    text = f'<path{style} d="{line}" marker-end="url(#end)"/>\n'
    if arrow.label:
        (x1, y1), (x2, y2) = points[0], points[-1]
        place = f'x="{(x1 + x2) / 2:.1f}" y="{(y1 + y2) / 2 - 4:.1f}"'
        text += f'<text class="label" {place} text-anchor="middle">{escape(arrow.label)}</text>\n'
    return text


def _bow(before: tuple[float, float], after: tuple[float, float]) -> str:
    if before[1] == after[1]:
        return f"L{_at(after)}"
    bend = max((after[0] - before[0]) / 2, 20.0)
    return f"C{before[0] + bend:.1f} {before[1]:.1f} {after[0] - bend:.1f} {after[1]:.1f} {_at(after)}"


def _at(point: tuple[float, float]) -> str:
    return f"{point[0]:.1f} {point[1]:.1f}"
