"""`ur completion`: the lines that make a shell complete `ur` with Tab."""

import os
from pathlib import PurePath

import click

from ur.complete.verbs import SCRIPTS


@click.command("completion")
@click.argument("shell", required=False, type=click.Choice(sorted(SCRIPTS)))
def command(shell: str | None) -> int:
    """Print the lines that let a shell complete `ur` with Tab.

    In ~/.bashrc: `eval "$(ur completion bash)"`, in ~/.zshrc likewise with zsh; for fish: `ur completion fish >
    ~/.config/fish/completions/ur.fish`. `ur setup` does that for you. Without a name: for the shell of this user.
    """
    own = PurePath(os.environ.get("SHELL", "")).name
    click.echo(SCRIPTS[shell or (own if own in SCRIPTS else "bash")], nl=False)
    return 0
