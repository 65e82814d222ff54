"""The folder of new files, and the report about them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import click

from ur.source.diagnostic import UserError, error
from ur.tools.new.parts import NewFile
from ur.tools.new.target import TargetPackage, find_target

SUMMARY = click.option("--summary", help="One line that says what it does.")
in_package = click.option(
    "--package", "-p", help="Name or folder of the package; without it the one around this folder."
)


class _Done:
    """Writes files, and prints their names and the next steps."""

    def __call__(self, target: TargetPackage, files: Sequence[NewFile], then: str) -> int:
        from ur.tools.new.write import write_files

        files = [_formatted(target, file) for file in files]
        write_files(target.folder, files)
        for file in files:
            click.echo(f"wrote {os.path.relpath(target.folder / file.path)}")
        click.echo(f"next: ur check {os.path.relpath(target.folder)}, then {then}", err=True)
        return 0

    @staticmethod
    def target(place: str | None) -> TargetPackage:
        """Return the package with a name or folder, or the one around the current folder. Raises UserError."""
        return find_target(place)

    @staticmethod
    def folder(name: str) -> TargetPackage:
        """Return the target of a new package. Raises UserError if the folder exists."""
        folder = Path.cwd() / name
        if folder.exists():
            raise UserError(error(f"{name} is there already, expected a new name", rule="file-exists", subject=name))
        return TargetPackage(name, folder)


show_done = _Done()


def _formatted(target: TargetPackage, file: NewFile) -> NewFile:
    if isinstance(file.text, bytes) or not file.path.endswith((".launch", ".launch.xml")):
        return file
    from dataclasses import replace

    from ur.check.computer import make_world
    from ur.request.environment import add_own_package
    from ur.tools.format.run import format_file

    path = str(target.folder / file.path)
    return replace(
        file,
        text=format_file(path, file.text.encode(), make_world([str(target.folder)], add_own_package(os.environ))).text,
    )
