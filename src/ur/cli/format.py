"""`ur format`: launch files in house order and layout, meaning what they meant."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from ur.format.run import Formatted

_STANDARD_INPUT = "-"


@click.command("format")
@click.argument("paths", nargs=-1, metavar="[PATH]...")
@click.option("--check", is_flag=True, help="Change nothing; end with exit code 1 when something would change.")
@click.option("--diff", is_flag=True, help="Change nothing; print what would change.")
def command(paths: tuple[str, ...], check: bool, diff: bool) -> int:
    """Put launch files in house order and layout.

    PATH is a launch file, a folder or a package; without one, the launch files below the current folder; `-` formats
    standard input to standard output. Comments stay. The plan of each file is compared, for every base and variant: a
    file that would mean something else keeps its order.

    Exit code: 0, or 1 when a file has errors (it stays as it is) or, with --check and --diff, would change.
    """
    if paths == (_STANDARD_INPUT,):
        return _format_input()
    from ur.check.collect import collect_targets
    from ur.check.computer import make_world
    from ur.check.worlds import CachedWorld
    from ur.cli.environment import know_own_package
    from ur.cli.replace_file import replace_file
    from ur.format.run import format_file
    from ur.source.diagnostic import UserError
    from ur.source.render import render_human

    words = list(paths) or ["."]
    world = CachedWorld(make_world(words, know_own_package(os.environ)))
    targets = collect_targets(words, world)
    changed = broken = 0
    for path in targets.launch_files:
        try:
            done = format_file(path, world.read_bytes(path), world, targets.package_of(path))
            if done.changed and not check and not diff:
                replace_file(path, done.text)
        except UserError as problem:
            broken += 1
            click.echo(render_human(problem.diagnostics, colour=sys.stderr.isatty()), err=True, nl=False)
            continue
        except OSError as problem:
            broken += 1
            click.echo(f"error: {path}: {(problem.strerror or str(problem)).lower()}", err=True)
            continue
        changed += done.changed
        _tell(done, check, diff)
    _sum_up(len(targets.launch_files), changed, broken, dry=check or diff)
    return 1 if broken or (changed and (check or diff)) else 0


def _format_input() -> int:
    from ur.check.computer import make_world
    from ur.cli.environment import know_own_package
    from ur.format.run import format_file

    data = sys.stdin.buffer.read()
    path = str(Path.cwd() / "<standard input>")
    click.echo(format_file(path, data, make_world(["."], know_own_package(os.environ))).text, nl=False)
    return 0


def _tell(done: Formatted, check: bool, diff: bool) -> None:
    name = os.path.relpath(done.path)
    if done.kept:
        click.echo(f"note: {name}: {done.kept}", err=True)
    if not done.changed:
        return
    if diff:
        import difflib

        lines = (done.before.splitlines(keepends=True), done.text.splitlines(keepends=True))
        click.echo("".join(difflib.unified_diff(*lines, f"{name} (now)", f"{name} (formatted)")), nl=False)
    else:
        click.echo(f"would format {name}" if check else f"formatted {name}")


def _sum_up(files: int, changed: int, broken: int, dry: bool) -> None:
    verb = "would change" if dry else "changed"
    errors = f", {broken} left alone because of errors" if broken else ""
    click.echo(f"{files} launch file{'' if files == 1 else 's'}: {changed} {verb}{errors}", err=True)
