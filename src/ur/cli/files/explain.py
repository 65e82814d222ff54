"""`ur explain`: where a name in a launch file got its value."""

from __future__ import annotations

import os
from pathlib import Path

import click


@click.command("explain")
@click.argument("words", nargs=-1, required=True, metavar="[PACKAGE] FILE [ARG:=VALUE]... NAME")
def command(words: tuple[str, ...]) -> int:
    """Explain where a name in a launch file got its value.

    NAME is a parameter, an argument, a remap or a node. It may lack its namespace: `rate` finds `/talker/rate`.
    The file and its arguments are given as for `ur launch`, in any order before or after NAME; arguments about the
    robot come from the selection. Nothing is started.
    """
    from ur.check.computer import make_world
    from ur.launchfile.address import join_addresses
    from ur.launchfile.query.explain import explain_name, format_layers
    from ur.launchfile.world.system import SystemWorld
    from ur.request.environment import apply_selection, current_selection
    from ur.request.plan_files import read_file_words
    from ur.source.progress_line import show_progress

    plain = [word for word in words if ":=" not in word]
    if len(plain) < 2:
        raise click.UsageError("expected FILE and NAME, for instance: ur explain robot.launch rate")
    selection = current_selection(os.environ)
    apply_selection(selection)
    world = SystemWorld(os.environ)
    if len(plain) == 2 and join_addresses(plain, world) != plain:
        raise click.UsageError(f"expected NAME after {' '.join(plain)}: a parameter, argument, remap or node")
    arguments = [word for word in words if ":=" in word]
    read = read_file_words([*plain[:-1], *arguments], world, selection, here=True)
    with show_progress(f"reading {' '.join(plain[:-1])}"):
        layers = explain_name(plain[-1], read.files, read.arguments, make_world(read.files, os.environ))
    click.echo(format_layers(layers).replace(f"{Path.cwd()}/", ""), nl=False)
    return 0
