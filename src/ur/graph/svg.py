"""SVG output of graphs, as a separate file."""

from html import escape
from itertools import pairwise

from ur.graph.boxes import Arrow, DrawnGraph, GraphBox
from ur.graph.layout import HEIGHT, BoxPosition, GraphLayout, lay_out_graph
from ur.source.printable import printable_lines

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
  .label, .note { font-size: 11px; fill: #5b6570; }
  @media (prefers-color-scheme: dark) {
    svg { background: #14181d; } rect { fill: #20262d; stroke: #8a95a3; } text { fill: #e4e9ef; }
    .node rect { fill: #163626; stroke: #3fb27a; } .topic rect { fill: #1a2a47; stroke: #7fa2e6; }
    .service rect, .action rect { fill: #3a2f14; stroke: #d1a548; }
    .missing rect, .cycle rect { fill: #431b1a; stroke: #ff6b62; } .missing text { fill: #ff9c95; }
    .label, .note { fill: #a5b0bd; }
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
    long = ", ".join(part for part in (box.title or box.label, box.note) if part)
    note = ""
    if box.note:
        note = (
            f'<text class="note" x="{middle:.1f}" y="{position.y + HEIGHT + 5:.1f}" text-anchor="middle">'
            f"{escape(box.note)}</text>"
        )
    return (
        f'<g class="{box.kind}"><title>{escape(long)}</title>'
        f'<rect x="{position.x:.1f}" y="{position.y:.1f}" width="{position.width:.1f}"'
        f' height="{position.height:g}" rx="6"/>'
        f'<text x="{middle:.1f}" y="{position.y + HEIGHT / 2 + 4.5:.1f}" text-anchor="middle">'
        f"{escape(box.label)}</text>{note}</g>\n"
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
