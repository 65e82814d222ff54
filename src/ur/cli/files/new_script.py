"""`ur new script`: a Python program that drives the selected robot."""

from __future__ import annotations

import re
from pathlib import Path

import click

from ur.source.diagnostic import UserError, error

_NAME = re.compile(r"[a-z][a-z0-9_]*")


@click.command("script")
@click.argument("name")
@click.option("--summary", default="Drive half a metre ahead", help="One line that says what it does.")
def new_script(name: str, summary: str) -> int:
    """Write a script NAME.py into this folder, which drives the selected robot half a metre ahead."""
    from ur.tools.new.script import plan_script
    from ur.tools.new.write import write_files

    name = name.removesuffix(".py")
    if not _NAME.fullmatch(name):
        expected = "expected lower-case letters, digits and _, starting with a letter"
        raise UserError(
            error(f"script name {name!r}, {expected}", rule="bad-options", help="ur new script look_around")
        )
    (file,) = plan_script(name, summary)
    write_files(Path.cwd(), [file])
    click.echo(f"wrote {file.path}")
    click.echo(f"next: ur run keyboard_navigate, then in another terminal: ur run {file.path}", err=True)
    return 0
