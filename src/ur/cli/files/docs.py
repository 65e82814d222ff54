"""`ur docs`: documents of a launch repository, generated from its launch files."""

from __future__ import annotations

import difflib
import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.source.foreign.files import read_file
from ur.source.printable import printable

if TYPE_CHECKING:
    from ur.docs.repository.collect import DocumentedRepository
    from ur.source.progress import Progress

_MAX_LINES = 400


def show_difference(path: str, old: str | None, new: str) -> str:
    """Return a unified difference, empty for equal texts. `old` is None for a missing file."""
    if old == new:
        return ""
    lines = list(
        difflib.unified_diff(
            _lines(old or ""), _lines(new), path if old is not None else "/dev/null", f"{path} (made again)"
        )
    )
    if len(lines) > _MAX_LINES:
        lines = [*lines[:_MAX_LINES], f"... and {len(lines) - _MAX_LINES} more lines\n"]
    return "".join(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines)


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


PAGE = "launches.md"


@click.command("docs")
@click.argument("path", default=".", metavar="[PACKAGE|PATH]")
@click.option("--check", is_flag=True, help="Write nothing; fail with the difference when something is out of date.")
@click.option("--output", metavar="FILE", help=f"Write the page there, - prints it [default: {PAGE} in PATH].")
def command(path: str, check: bool, output: str | None) -> int:
    """Write a page of documents of launch files.

    The page is resolved for every base and variant, so that it also shows includes that depend on the base. It is the
    same on every computer.

    Exit code: 0, or 1 when --check finds a difference, or 2 when there is nothing to document. Files that cannot be
    read are reported and documented as broken; `ur check` explains them.
    """
    import gc

    from ur.source.progress_line import show_progress

    gc.disable()  # all objects are needed until the end
    with show_progress("finding launch files") as progress:
        return _write_documents(path, check, output, progress)


def _write_documents(path: str, check: bool, output: str | None, progress: Progress) -> int:
    from ur.docs.repository.collect import collect_repository
    from ur.launchfile.world import SystemWorld
    from ur.request.environment import add_own_package

    repository = collect_repository(path, SystemWorld(add_own_package(os.environ)), progress)
    _report(repository)
    if output == "-" and not check:
        click.echo(_page(repository, repository.root, progress), nl=False)
        return 0
    target = Path(output) if output else Path(repository.root) / PAGE
    if output and not check:
        from ur.source.replace import check_output

        check_output(target, map(str, repository.trees), b"# ")
    # A symbolic link in the repository may lead anywhere.
    page = _page(repository, str(target.absolute().parent), progress)
    return _compare(target, page) if check else _write(target, page, follow=output is not None)


def _report(repository: DocumentedRepository) -> None:
    import sys

    from ur.check.rule import describe_left_out
    from ur.source.render import render_human, shows_colour

    sys.stderr.write(render_human(repository.findings, colour=shows_colour(sys.stderr)))
    if note := describe_left_out(repository.left_out):
        click.echo(note, err=True)


def _page(repository: DocumentedRepository, folder: str, progress: Progress) -> str:
    from ur.docs.build import describe_repository
    from ur.docs.markdown.page import render_markdown

    # Links in the page are relative to its folder.
    relative_path = os.path.relpath(repository.root, folder)
    return render_markdown(
        describe_repository(repository, progress), "" if relative_path == "." else f"{relative_path}/"
    )


def _write(path: Path, text: str, *, follow: bool) -> int:
    from ur.cli.output import replace_file

    changed = _read(path) != text
    if changed:
        replace_file(path, text, parents=True, follow=follow)
    click.echo(f"{_short(path)}: {'written' if changed else 'up to date'}", err=True)
    return 0


def _compare(path: Path, text: str) -> int:
    difference = show_difference(_short(path), _read(path), text)
    click.echo(difference, nl=False)
    if difference:
        click.echo(f"{_short(path)} is out of date", err=True)
        click.echo("  help: the same command without --check brings it up to date", err=True)
    else:
        click.echo(f"{_short(path)}: up to date", err=True)
    return 1 if difference else 0


def _read(path: Path) -> str | None:
    try:
        return read_file(path).decode("utf-8", "surrogateescape")
    except OSError:
        return None


def _short(path: Path) -> str:
    relative_path = os.path.relpath(path)
    return printable(relative_path if not relative_path.startswith("../..") else str(path))
