"""`ur explain`: where a name in a launch file got its value."""

from __future__ import annotations

import os
from pathlib import Path

import click


@click.command("explain")
@click.argument("words", nargs=-1, required=True, metavar="[PACKAGE] FILE NAME [ARG:=VALUE]...")
def command(words: tuple[str, ...]) -> int:
    """Say where a name in a launch file got its value.

    NAME is a parameter, an argument, a remap or a node. It may lack its namespace: `rate` finds `/talker/rate`.
    Arguments are given as for `ur launch`; nothing is started.
    """
    from ur.check.computer import make_world
    from ur.launchfile.address import resolve_addresses
    from ur.launchfile.query.explain import explain_name, format_layers
    from ur.launchfile.world.system import SystemWorld

    plain = [word for word in words if ":=" not in word]
    if len(plain) < 2:
        raise click.UsageError("expected FILE and NAME, for instance: ur explain robot.launch rate")
    files = resolve_addresses(plain[:-1], SystemWorld(os.environ))
    world = make_world(files, os.environ)
    layers = explain_name(plain[-1], files, [word for word in words if ":=" in word], world)
    click.echo(format_layers(layers).replace(f"{Path.cwd()}/", ""), nl=False)
    return 0
