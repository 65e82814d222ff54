"""`ur format`: order and layout of launch files, without a change of their meaning."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.cli.output import replace_file, write_exactly
from ur.source.printable import printable, printable_lines

if TYPE_CHECKING:
    from ur.check.collect import Targets
    from ur.check.worlds import CachedWorld
    from ur.source.progress import Progress
    from ur.tools.format.run import Formatted

_STANDARD_INPUT = "-"


@click.command("format")
@click.argument("paths", nargs=-1, metavar="[PATH]...")
@click.option("--check", is_flag=True, help="Change nothing; end with exit code 1 when something would change.")
@click.option("--diff", is_flag=True, help="Change nothing; print what would change.")
def command(paths: tuple[str, ...], check: bool, diff: bool) -> int:
    """Format launch files: a standard order and layout.

    Comments stay. The plan of each file is compared, for every base and variant: a file whose plan would change keeps
    its order.

    Exit code: 0, or 1 when a file has errors (it stays as it is) or, with --check and --diff, would
    change; 2 when there are launch files of ROS 2 only.
    """
    if paths == (_STANDARD_INPUT,):
        return _format_input()
    from ur.check.collect import collect_targets
    from ur.check.rule import describe_left_out
    from ur.check.worlds import CachedWorld, make_world
    from ur.launchfile.syntax.parse import count_unread, describe_unread, is_ros2_name
    from ur.request.environment import add_own_package
    from ur.source.progress_line import show_progress

    places = list(paths) or ["."]
    world = CachedWorld(make_world(places, add_own_package(os.environ)))
    with show_progress("finding launch files") as progress:
        targets = collect_targets(places, world)
        named = {world.absolute(each) for each in places}
        skipped = [each for each in targets.launch_files if is_ros2_name(each) and each not in named]
        unread = describe_unread(count_unread(skipped))
        targets = targets._replace(launch_files=tuple(each for each in targets.launch_files if each not in skipped))
        changed, broken = _format_files(targets, world, progress, check=check, diff=diff)
    if note := describe_left_out(targets.left_out):
        click.echo(note, err=True)
    unread = f"; {unread}" if unread else ""
    if not (files := len(targets.launch_files)):
        click.echo(f"nothing was formatted: no launch file is there{unread}", err=True)
        return 2 if unread else 0
    verb = "would change" if check or diff else "changed"
    errors = f", {broken} left alone because of errors" if broken else ""
    click.echo(f"{files} launch file{'' if files == 1 else 's'}: {changed} {verb}{errors}{unread}", err=True)
    return 1 if broken or (changed and (check or diff)) else 0


def _format_files(
    targets: Targets, world: CachedWorld, progress: Progress, *, check: bool, diff: bool
) -> tuple[int, int]:
    """Format the launch files, and return the numbers of those that change and of those with errors."""
    from ur.source.diagnostic import UserError
    from ur.source.progress import counted
    from ur.source.render import render_human, shows_colour
    from ur.tools.format.run import format_file

    changed = broken = 0
    for path in counted(targets.launch_files, "formatting", "launch files", progress):
        try:
            done = format_file(path, world.read_bytes(path), world, targets.package_of(path))
            if done.changed and not check and not diff:
                replace_file(path, done.text)
        except UserError as problem:
            broken += 1
            click.echo(render_human(problem.diagnostics, colour=shows_colour(sys.stderr)), err=True, nl=False)
            continue
        except OSError as problem:
            broken += 1
            click.echo(f"error: {printable(path)}: {(problem.strerror or str(problem)).lower()}", err=True)
            continue
        changed += done.changed
        _print_result(done, check, diff)
    return changed, broken


def _format_input() -> int:
    from ur.check.worlds import make_world
    from ur.request.environment import add_own_package
    from ur.tools.format.run import format_file

    data = sys.stdin.buffer.read()
    path = str(Path.cwd() / "<standard input>")
    text = format_file(path, data, make_world(["."], add_own_package(os.environ))).text
    write_exactly(text)
    return 0


def _print_result(done: Formatted, check: bool, diff: bool) -> None:
    name = printable(os.path.relpath(done.path))
    if done.kept:
        click.echo(f"note: {name}: {done.kept}", err=True)
    if not done.changed:
        return
    if diff:
        import difflib

        lines = (done.before.splitlines(keepends=True), done.text.splitlines(keepends=True))
        difference = "".join(difflib.unified_diff(*lines, f"{name} (now)", f"{name} (formatted)"))
        click.echo(printable_lines(difference), nl=False)
    else:
        click.echo(f"would format {name}" if check else f"formatted {name}")
