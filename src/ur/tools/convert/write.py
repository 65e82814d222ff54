"""Converted files in a folder, or in one from which `ros2 launch` starts a package."""

import os
from collections.abc import Iterator
from pathlib import Path

from ur.source.diagnostic import user_error, user_error_about
from ur.source.replace import replace_file
from ur.tools.convert.package import ConvertedFile, ConvertedFiles

_MARK = ".made-by-ur-convert"
_SKIPPED = frozenset({"__pycache__", ".git"})


def write_output(made: ConvertedFiles, folder: Path) -> None:
    """Write the files as they lie in their package, below its name where there are several. Raises UserError."""
    several = len({each.package for each in made.launch_files}) > 1
    _fill(
        folder, {_target(folder, each, several): each.text for each in (*made.launch_files, *made.parameter_files)}, {}
    )


def _target(folder: Path, file: ConvertedFile, several: bool) -> Path:
    return folder / file.package / file.place if several else folder / file.place


def write_prefix(made: ConvertedFiles, folder: Path) -> None:
    """Write the files below share/, with links to all others of their packages and to their programs."""
    texts = {
        folder / "share" / each.package / each.place: each.text for each in (*made.launch_files, *made.parameter_files)
    }
    links: dict[Path, Path] = {}
    for name, source in made.packages.items():
        texts[folder / "share/ament_index/resource_index/packages" / name] = ""
        for file in _list_files(Path(source)):
            links.setdefault(folder / "share" / name / file.relative_to(source), file)
            if os.access(file, os.X_OK):
                links.setdefault(folder / "lib" / name / file.name, file)
    _fill(folder, texts, {place: source for place, source in links.items() if place not in texts})


def _list_files(folder: Path) -> Iterator[Path]:
    for above, folders, names in os.walk(folder):
        folders[:] = sorted(each for each in folders if each not in _SKIPPED)
        yield from (Path(above, name) for name in sorted(names))


def _fill(folder: Path, texts: dict[Path, str], links: dict[Path, Path]) -> None:
    try:
        if folder.exists() and not (folder / _MARK).is_file() and any(folder.iterdir()):
            message = f"{folder} holds other files, expected a new folder or one that this command has made"
            raise user_error(message, rule="folder-in-use", help=f"give a new folder: {folder}/ros2")
        replace_file(folder / _MARK, "", parents=True)
        for place, text in texts.items():
            replace_file(place, text, parents=True, follow=False, lasting=False)
        for place, source in links.items():
            place.parent.mkdir(parents=True, exist_ok=True)
            if place.is_symlink():
                place.unlink()
            place.symlink_to(source)
    except OSError as problem:
        reason = f"{(problem.strerror or str(problem)).lower()}, expected a folder to write to"
        raise user_error_about(folder, reason, rule="unwritable-file", help="give another folder") from None
