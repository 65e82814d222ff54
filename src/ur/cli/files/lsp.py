"""`ur lsp`: the language server for launch files."""

import os
from collections.abc import Sequence

import click

from ur.request.requirements.python_packages import need_all


@click.command("lsp")
@click.option("--stdio", is_flag=True, help="Use standard input and output, which is the default.")
def command(stdio: bool) -> int:  # noqa: ARG001 - what some editors give
    """Serve an editor: findings while you type, completion, definitions.

    Editors start it and use the Language Server Protocol over its standard input and output.

    Exit code: 0 when the editor ends it, 2 when it could not start.
    """
    need_all(["pygls"], "lsp.lock", "what editors need (1 MB to download)")
    from importlib.metadata import version

    from ur.check.worlds import make_world
    from ur.launchfile.world import World
    from ur.lsp.serve import make_server
    from ur.request.environment import add_own_package

    environment = add_own_package(os.environ)

    def world_of(paths: Sequence[str]) -> World:
        return make_world(paths, environment)

    make_server(version("ubiquity-launches"), world_of).start_io()
    return 0
