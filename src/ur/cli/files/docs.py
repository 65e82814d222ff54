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
    from collections.abc import Mapping

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
@click.option("--doc-attributes", is_flag=True, help="Write the comments of arguments into the files, as doc=.")
def command(path: str, check: bool, output: str | None, doc_attributes: bool) -> int:
    """Write a page of documents of launch files.

    PATH is a package, a folder of packages, or any folder with launch files; without one, the current folder. The page
    is resolved for every base and variant, so that it also shows includes that depend on the base. It is the same on
    every computer.

    With --doc-attributes the comments after arguments are written into the launch files as doc=, which `roslaunch
    --ros-args` shows; the rest of the files is unchanged.

    Exit code: 0, or 1 when --check finds a difference, or 2 when there is nothing to document. Files that cannot be
    read are reported and documented as broken; `ur check` explains them.
    """
    import gc

    was_enabled = gc.isenabled()
    gc.disable()  # all objects are needed until the end
    try:
        return _make(path, check, output, doc_attributes)
    finally:
        if was_enabled:
            gc.enable()


def _make(path: str, check: bool, output: str | None, doc_attributes: bool) -> int:
    from ur.source.progress_line import show_progress

    with show_progress("finding launch files") as progress:
        return _write_documents(path, check, output, doc_attributes, progress)


def _write_documents(path: str, check: bool, output: str | None, doc_attributes: bool, progress: Progress) -> int:
    from ur.docs.repository.collect import collect_repository
    from ur.launchfile.world import SystemWorld
    from ur.request.environment import add_own_package

    repository = collect_repository(path, SystemWorld(add_own_package(os.environ)), progress)
    _report(repository)
    if doc_attributes:
        return _settle(_doc_attributes(repository), check)
    if output == "-" and not check:
        click.echo(_page(repository, repository.root, progress), nl=False)
        return 0
    target = Path(output) if output else Path(repository.root) / PAGE
    if output and not check:
        from ur.source.replace import check_output

        check_output(target, map(str, repository.trees), b"# ")
    # A symbolic link in the repository may lead anywhere.
    page = _page(repository, str(target.absolute().parent), progress)
    return _settle({target: page}, check, follow=output is not None)


def _report(repository: DocumentedRepository) -> None:
    import sys

    from ur.check.links import describe_left_out
    from ur.source.render import render_human, shows_colour

    sys.stderr.write(render_human(repository.findings, colour=shows_colour(sys.stderr)))
    if note := describe_left_out(repository.left_out):
        click.echo(note, err=True)


def _page(repository: DocumentedRepository, folder: str, progress: Progress) -> str:
    from ur.docs.build import describe_repository
    from ur.docs.markdown.page import render_markdown

    # Links in the page are relative to its folder.
    way = os.path.relpath(repository.root, folder)
    return render_markdown(describe_repository(repository, progress), "" if way == "." else f"{way}/")


def _doc_attributes(repository: DocumentedRepository) -> dict[Path, str]:
    from ur.docs.doc_attributes import add_doc_attributes

    changed = {}
    for path, tree in repository.trees.items():
        text = add_doc_attributes(tree)
        if text == tree.source.text:
            continue
        if _read(Path(path)) == tree.source.text:
            changed[Path(path)] = text
        else:
            click.echo(f"{_short(Path(path))} is not UTF-8 and stays as it is", err=True)
    return changed


def _settle(files: Mapping[Path, str], check: bool, *, follow: bool = True) -> int:
    from ur.cli.output import replace_file

    differences, fresh = [], 0
    for path, text in sorted(files.items()):
        old = _read(path)
        if old != text:
            fresh += not path.exists()
            differences.append(show_difference(_short(path), old, text))
            if not check:
                replace_file(path, text, parents=True, follow=follow)
    if not check:
        names = ", ".join(_short(path) for path in sorted(files)[:3]) + (", ..." if len(files) > 3 else "")
        counts = f"{fresh} new, {len(differences) - fresh} changed, {len(files) - len(differences)} up to date"
        written = f"{len(files)} files ({counts}): {names}" if files else "nothing to change"
        click.echo(written if len(files) != 1 else f"{names}: {'written' if differences else 'up to date'}", err=True)
        return 0
    click.echo("".join(differences), nl=False)
    if differences:
        click.echo(f"{len(differences)} file{'s are' if len(differences) > 1 else ' is'} out of date", err=True)
        click.echo("  help: the same command without --check brings them up to date", err=True)
    elif files:
        click.echo(f"{', '.join(map(_short, sorted(files)[:3]))}: up to date", err=True)
    else:
        click.echo("nothing to change", err=True)
    return 1 if differences else 0


def _read(path: Path) -> str | None:
    try:
        return read_file(path).decode("utf-8", "surrogateescape")
    except OSError:
        return None


def _short(path: Path) -> str:
    return printable(_shorten(path))


def _shorten(path: Path) -> str:
    way = os.path.relpath(path)
    return way if not way.startswith("../..") else str(path)
