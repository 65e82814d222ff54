"""`ur graph`: a picture of a launch file, or of running nodes."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.graph.topics import graph_plan, graph_system
from ur.run.middleware.protocol import GraphView, NoGraph, RunGraph
from ur.source.ansi import speaks_unicode
from ur.source.diagnostic import user_error
from ur.source.printable import printable
from ur.source.progress_line import show_progress

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ur.graph.boxes import Branch, DrawnGraph
    from ur.graph.text import Line

_COLOURS: dict[str, dict[str, object]] = {
    "file": {"bold": True},
    "node": {"fg": "green"},
    "topic": {"fg": "blue"},
    "service": {"fg": "yellow"},
    "action": {"fg": "yellow"},
    "missing": {"fg": "red", "bold": True},
    "cycle": {"fg": "red", "bold": True},
    "line": {"dim": True},
    "note": {"dim": True},
}


_PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".webp", ".pdf")


@click.command("graph")
@click.argument("argv", nargs=-1, metavar="[PACKAGE] FILE [ARG:=VALUE]... | [NODE]...")
@click.option("--topics", is_flag=True, help="Draw nodes and topics, without starting them.")
@click.option("--live", is_flag=True, help="Draw the nodes and topics that run now; NODE limits it to neighbours.")
@click.option(
    "--as",
    "form",
    type=click.Choice(["text", "svg"]),
    help="The format; by default that of --output's name, else text.",
)
@click.option("--output", "-o", type=click.Path(dir_okay=False), help="Write to a file.")
def command(argv: tuple[str, ...], topics: bool, live: bool, form: str | None, output: str | None) -> int:
    """Draw what a launch file includes and starts, or what runs.

    Without an option: the tree of included files and their nodes; files that are missing, and files that include
    themselves, are red. Arguments about the robot come from the selection, as for `ur launch`. Nothing is started.

    Exit code: 0; 1 when the launch file has errors (what can be drawn is drawn), 2 when there is nothing to draw.
    """
    if not argv and not live:
        raise click.UsageError("expected a launch file, or --live, for instance: ur graph robot.launch")
    if form is None and Path(output or "").suffix.lower() in _PICTURES:
        message = (
            f"{output!r} cannot be written: graphs are drawn as SVG, not as {Path(str(output)).suffix[1:].upper()}"
        )
        raise user_error(message, rule="unknown-format", help=f"-o {Path(str(output)).with_suffix('.svg')}")
    form = form or ("svg" if Path(output or "").suffix == ".svg" else "text")
    if live:
        return _write(_show_live(argv, form), output)
    from ur.graph.includes import build_trees, merge_trees
    from ur.request.plan_files import load_tolerantly

    plan, files, sound = load_tolerantly(argv)
    title = " ".join(argv)
    with show_progress(f"drawing {title}"):
        if topics:
            text = _render(graph_plan(plan), form, title)
        else:
            trees = build_trees(plan, files)
            text = _draw_trees(trees) if form == "text" else _render(merge_trees(trees), form, title)
    _write(text, output, files)
    return 0 if sound else 1


def _draw_trees(trees: Sequence[Branch]) -> str:
    from ur.graph.text import draw_tree

    return "".join(_paint(draw_tree(tree, unicode=speaks_unicode(sys.stdout.encoding, os.environ))) for tree in trees)


def _show_live(nodes: Sequence[str], form: str) -> str:
    from ur.request.environment import apply_selection, current_selection
    from ur.run.master.client import parse_master_uri
    from ur.run.master.xml_rpc import Unanswered

    apply_selection(current_selection(os.environ))
    if os.environ.get("ROS_VERSION") == "2":
        return _show_domain(nodes, form)
    if os.environ.get("ROS_VERSION") == "0":
        message = "--live needs ROS: without it all nodes are in one process, which no other program sees"
        raise user_error(message, rule="no-master", help="ur graph --topics FILE draws what they use")
    master = parse_master_uri(os.environ["ROS_MASTER_URI"])
    try:
        with show_progress(f"waiting for the master at {master.uri} to answer"):
            state = master.get_system_state()
    except Unanswered:
        message = f"no master answers at {master.uri}, expected one"
        raise user_error(message, rule="no-master", help="start something: ur run keyboard_drive") from None
    wanted = _find_nodes(nodes, state[:2], f"known to the master at {master.uri}")
    return _render(graph_system(state, wanted), form, f"nodes and topics at {master.uri}")


def _show_domain(nodes: Sequence[str], form: str) -> str:
    from ur.run.middleware.helper_view import HelperView

    where = f"domain {os.environ.get('ROS_DOMAIN_ID') or '0'}"
    try:
        with show_progress(f"waiting for the nodes of {where} to be discovered"):
            graph = read_settled(HelperView(os.environ))
    except NoGraph as problem:
        raise user_error(str(problem), rule="no-graph", help="ur doctor") from None
    state = (tuple(graph.publishers.items()), tuple(graph.subscribers.items()))
    if not any(state):
        message = f"no node is in {where}, expected one"
        raise user_error(message, rule="no-graph", help="start something: ur run keyboard_drive")
    return _render(graph_system(state, _find_nodes(nodes, state, f"in {where}")), form, f"nodes and topics in {where}")


def _find_nodes(nodes: Sequence[str], state: Sequence[Iterable[tuple[str, Sequence[str]]]], where: str) -> list[str]:
    """Return the full names of nodes. Raises UserError if one does not exist."""
    known = {node for part in state for _, names in part for node in names}
    wanted = [name if name.startswith("/") else f"/{name}" for name in nodes]
    for name in wanted:
        if name not in known:
            from ur.source.suggest import suggest

            message = f"no node {name} is {where}, expected one of {', '.join(sorted(known))}"
            raise user_error(message, rule="unknown-node", help=suggest(name, known))
    return wanted


def _render(graph: DrawnGraph, form: str, title: str) -> str:
    from ur.graph.text import draw_graph

    if form == "svg":
        from ur.graph.svg import write_svg

        return write_svg(graph, title)
    return _paint(draw_graph(graph, unicode=speaks_unicode(sys.stdout.encoding, os.environ)))


def _paint(lines: Iterable[Line]) -> str:
    return "".join("".join(_style(text, kind) for text, kind in line) + "\n" for line in lines)


def _style(text: str, kind: str) -> str:
    return click.style(printable(text), **_COLOURS[kind])  # type: ignore[arg-type]  # the options of style, by name


def _write(text: str, output: str | None, inputs: Iterable[str] = ()) -> int:
    if output is None:
        click.echo(text, nl=False)
        return 0
    from ur.source.replace import output_file

    content = click.unstyle(text).encode()
    with output_file(output, inputs, content[:4]) as file:
        file.write(content)
    click.echo(f"wrote {output}", err=True)
    return 0


PERIOD = 0.25  # s between two looks
_QUIET = 4  # looks without a change
_MOST = 40  # looks


def read_settled(view: GraphView) -> RunGraph:
    """Read the graph until it is unchanged for a second, at most for ten seconds. Raises NoGraph."""
    graph, quiet = view.look(()), 0
    for _ in range(_MOST):
        if quiet >= _QUIET and graph.topics():
            break
        view.wait(PERIOD)
        newer = view.look(())
        quiet = quiet + 1 if newer == graph else 0
        graph = newer
    view.forget()
    return graph
