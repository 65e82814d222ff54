"""Writing of new files: all of them or none, also when this process is killed, without overwriting any."""

import os
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path

from ur.source.diagnostic import UserError, error, error_about
from ur.source.foreign.files import read_file
from ur.source.replace import make_folder, replacing, sync_folder
from ur.tools.new.parts import NewFile


def write_files(package: Path, files: Sequence[NewFile]) -> None:
    """Write files below a package. Raises UserError, without writing any, if one exists or cannot be written.

    A new package is complete or absent. In an existing one, the first file, which the others belong to, gets its name
    last; files that a killed command has left are taken if they are the same.
    """
    whole = package if package.exists() else package.with_name(f".{package.name}.{os.urandom(4).hex()}.ur-new")
    found = [file for file in files if os.path.lexists(package / file.path)]
    other = next((file for file in found if len(found) == len(files) or not _is_written(package, file)), None)
    if other is not None:
        message = f"{other.path} is there already, expected a new name"
        help_ = f"look at {package / other.path}"
        raise UserError(error(message, rule="file-exists", help=help_, subject=other.path))
    paths = {file.path: whole / file.path for file in files if file not in found}
    above = {each for path in paths.values() for each in _missing_folders(path.parent)}
    try:
        with ExitStack() as stack:  # which ends with the first file
            for file in files:
                if file.path in paths:
                    make_folder(str(paths[file.path].parent))
                    out = stack.enter_context(replacing(paths[file.path], mode=0o775 if file.executable else 0o664))
                    out.write(_content(file))
        if whole != package:
            whole.rename(package)
            sync_folder(str(package.parent))
    except BaseException as problem:
        for path in paths.values():
            if path.is_file():
                path.unlink()
        for folder in sorted(above, reverse=True):
            with suppress(OSError):
                folder.rmdir()
        if isinstance(problem, OSError):
            reason = (problem.strerror or str(problem)).lower()
            raise UserError(error_about(problem.filename or package, f"{reason}", rule="unwritable-file")) from None
        raise


def _content(file: NewFile) -> bytes:
    return file.text.encode() if isinstance(file.text, str) else file.text


def _is_written(package: Path, file: NewFile) -> bool:
    path = package / file.path
    return path.is_file() and not path.is_symlink() and read_file(path) == _content(file)


def _missing_folders(folder: Path) -> list[Path]:
    return [each for each in (folder, *folder.parents) if not each.exists()]
