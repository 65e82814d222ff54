"""`ur explain`: the origin of a value in a launch file."""

import os
from pathlib import Path

import click


@click.command("explain")
@click.argument("argv", nargs=-1, required=True, metavar="[PACKAGE] FILE [ARG:=VALUE]... NAME")
def command(argv: tuple[str, ...]) -> int:
    """Explain where a name in a launch file got its value.

    NAME may lack its namespace: `rate` finds `/talker/rate`. The file and its arguments are given as for `ur launch`,
    in any order before or after NAME; arguments about the robot come from the selection. Nothing is started.
    """
    from ur.check.worlds import make_world
    from ur.launchfile.address import join_addresses
    from ur.launchfile.query.explain import explain_name, format_layers
    from ur.launchfile.world.system import SystemWorld
    from ur.request.bases.base_argument import describe_base_of
    from ur.request.environment import apply_selection, current_selection
    from ur.request.launch_request import make_request
    from ur.request.plan_files import complete_arguments, texts
    from ur.source.arguments import split_argv
    from ur.source.progress_line import show_progress

    line = split_argv(argv)
    names = line.names
    if len(names) < 2:
        raise click.UsageError("missing argument 'FILE' or 'NAME', for instance: ur explain robot.launch rate")
    selection = current_selection(os.environ)
    apply_selection(selection)
    world = SystemWorld(os.environ)
    if len(names) == 2 and join_addresses(names, world) != list(names):
        raise click.UsageError(f"expected NAME after {' '.join(names)}: a parameter, argument, remap or node")
    request = make_request(line._replace(names=names[:-1]), world, selection)
    files, completed = request.files, texts(complete_arguments(request, local=True))
    with show_progress(f"reading {' '.join(names[:-1])}"):
        checked = make_world(files.paths, os.environ)
        layers = explain_name(names[-1], files.paths, completed, checked, files.parsed, describe_base_of)
    click.echo(format_layers(layers).replace(f"{Path.cwd()}/", ""), nl=False)
    return 0
