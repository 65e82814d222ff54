"""`ur find`: definitions and uses of a name in launch files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.source.printable import printable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ur.tools.find.search import Occurrence

_KINDS = ("arg", "node", "topic", "param", "file")  # as ur.tools.find.search has them; a test compares


@click.command("find")
@click.argument("name")
@click.argument("paths", nargs=-1, metavar="[PATH]...")
@click.option("--kind", "kinds", multiple=True, type=click.Choice(_KINDS), help="Find only these; may be repeated.")
@click.option("--json", "as_json", is_flag=True, help="Print a list that programs can read.")
def command(name: str, paths: tuple[str, ...], kinds: tuple[str, ...], as_json: bool) -> int:
    """Find where a name in launch files is defined and used.

    NAME may lack its namespace or folder (`scan` finds `/robot/scan`), and `*` stands for any characters. Launch files
    are resolved for each base and variant, so names that depend on arguments are found, too.

    Exit code: 0 when something is found, 1 when nothing is.
    """
    from ur.check.worlds import make_world
    from ur.request.environment import add_own_package
    from ur.source.progress_line import show_progress
    from ur.tools.find.search import KINDS, find_name

    places = list(paths) or ["."]
    world = make_world(places, add_own_package(os.environ))
    with show_progress("finding launch files") as progress:
        found = find_name(name, places, world, [kind for kind in KINDS if not kinds or kind in kinds], progress)
    if as_json:
        import json

        click.echo(json.dumps([_plain(each) for each in found], indent=2))
    elif found:
        _show(found)
    else:
        click.echo(f"no {name!r} in {', '.join(places)}; use * as a wildcard: ur find '*{name}*'", err=True)
    return 0 if found else 1


def _plain(each: Occurrence) -> dict[str, object]:
    line, column = each.span.position
    return {
        "kind": each.kind,
        "name": each.name,
        "role": "definition" if each.defines else "use",
        "path": each.span.file.path,
        "line": line,
        "column": column,
        "note": each.note,
    }


def _show(found: Sequence[Occurrence]) -> None:
    title = ""
    for each in found:
        name = os.path.relpath(each.name) if each.kind == "file" else each.name
        if title != (title := printable(f"{each.kind} {name}")):
            click.secho(title, bold=True)
        if each.kind == "file" and each.defines:
            continue
        line, column = each.span.position
        place = f"{os.path.relpath(each.span.file.path, Path.cwd())}:{line}:{column}"
        role = "defined" if each.defines else "used   "
        note = f"  ({each.note})" if each.note else ""
        click.echo(printable(f"  {role}  {place}{note}"))
        click.secho(printable(f"             {' '.join(each.span.file.line(line).split())}"), dim=True)
