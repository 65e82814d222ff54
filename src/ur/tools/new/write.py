"""Writing of new files: all of them or none, without overwriting any."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from ur.source.diagnostic import UserError, error, error_about
from ur.source.replace import sync_folder
from ur.tools.new.parts import NewFile


def write_files(package: Path, files: Sequence[NewFile]) -> None:
    """Write files below a package. Raises UserError, without writing any, if one exists or cannot be written."""
    there = [file.path for file in files if os.path.lexists(package / file.path)]
    if there:
        raise UserError(
            error(
                f"{there[0]} is there already, expected a new name",
                rule="file-exists",
                help=f"look at {package / there[0]}",
                subject=there[0],
            )
        )
    made: list[Path] = []
    try:
        for file in files:
            path = package / file.path
            for folder in _missing_folders(path.parent):
                folder.mkdir()
                made.append(folder)
            with path.open("xb") as out:
                made.append(path)
                out.write(file.text.encode() if isinstance(file.text, str) else file.text)
                out.flush()
                os.fsync(out.fileno())
            if file.executable:
                path.chmod(path.stat().st_mode | 0o111)
        for folder in sorted({each.parent for each in made}):
            sync_folder(str(folder))
    except BaseException as problem:
        for path in reversed(made):
            if path.is_dir():
                path.rmdir()
            else:
                path.unlink(missing_ok=True)
        if isinstance(problem, OSError):
            reason = (problem.strerror or str(problem)).lower()
            raise UserError(error_about(problem.filename or package, f"{reason}", rule="unwritable-file")) from None
        raise


def _missing_folders(folder: Path) -> list[Path]:
    missing = []
    while not folder.exists():
        missing.append(folder)
        folder = folder.parent
    return list(reversed(missing))
