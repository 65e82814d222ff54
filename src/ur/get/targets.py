"""Missing packages of what a command line names: launch files, packages, folders."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.get.index import read_dependencies
from ur.get.missing import is_installed, missing_of_names, missing_of_plan, named_packages
from ur.get.model import PACKAGE_NAME, Missing
from ur.launchfile.plan.load import load_plan
from ur.launchfile.world.system import SystemWorld
from ur.request.launch_request import make_request
from ur.source.diagnostic import Severity, UserError, error
from ur.source.progress import Progress, no_progress

SUFFIXES = (".launch", ".launch.xml", ".test")
_TEXTS = (*SUFFIXES, ".xacro")
_MAX_TEXT = 4 * 1024 * 1024  # bytes
_SKIPPED = frozenset({".git", ".hg", ".svn", "build", "devel", "node_modules"})


@dataclass(frozen=True, slots=True)
class Needs:
    """Missing packages, a test for packages that are there, and notes on what could not be read."""

    missing: tuple[Missing, ...]
    is_there: Callable[[str], bool]
    notes: tuple[str, ...] = ()


def find_needs(words: Sequence[str], environment: Mapping[str, str]) -> Needs:
    """Find what is missing for a launch file with its arguments, for folders, or for packages. Raises UserError."""
    world = SystemWorld(environment)
    named = [word for word in words if ":=" not in word]
    if any(word.endswith(SUFFIXES) for word in named) or (len(named) == 1 and Path(named[0]).is_file()):
        return _file_needs(words, world)
    if len(named) != len(words):
        raise UserError(
            error("NAME:=VALUE is given, expected it after a launch file", rule="usage", help="ur get --help")
        )
    found: dict[str, Missing] = {}
    notes: tuple[str, ...] = ()
    for word in words:
        if "/" in word or word in (".", ".."):
            needs = folder_needs([word], environment)
            world, notes = SystemWorld(_with_folders([word], environment)), (*notes, *needs.notes)
            found.update((each.package, each) for each in needs.missing)
        elif not PACKAGE_NAME.fullmatch(word):
            message = f"{word!r} is neither a launch file nor the name of a package"
            raise UserError(error(message, rule="unknown-package", help="ur get --help"))
        elif is_installed(word, world):
            text = _read(Path(world.find_package(word)) / "package.xml")
            found.update((each.package, each) for each in missing_of_names(_dependencies(text), world))
        else:
            found[word] = Missing(word)
    return Needs(tuple(found.values()), lambda name: is_installed(name, world), notes)


def folder_needs(
    folders: Sequence[str], environment: Mapping[str, str], progress: Progress = no_progress, *, manifests: bool = True
) -> Needs:
    """Find what all launch files, xacro files and (`manifests`) package.xml below folders need. Raises UserError.

    Packages in the folders count as installed: they are built there.
    """
    for folder in folders:
        if not Path(folder).is_dir():
            message = f"folder {folder!r} does not exist, expected one with launch files"
            raise UserError(error(message, rule="missing-file", help="ur get --missing FOLDER"))
    world = SystemWorld(_with_folders(folders, environment))
    names: set[str] = set()
    for count, path in enumerate(_list_texts(folders)):
        if count % 50 == 0:
            progress(f"{count} files read")
        text = _read(path)
        if path.name != "package.xml":
            names |= named_packages(text)
        elif manifests:
            names.update(_dependencies(text))
    return Needs(missing_of_names(names, world), lambda name: is_installed(name, world))


def _file_needs(words: Sequence[str], world: SystemWorld) -> Needs:
    request = make_request(words, world)
    plan = load_plan(request.files.paths, [str(each) for each in request.arguments], world, parsed=request.files.parsed)
    others = [
        each for each in plan.diagnostics if each.severity is Severity.ERROR and each.rule not in
        ("unknown-package", "missing-executable")
    ]  # fmt: skip
    notes = (f"not everything was read: {others[0].message}",) if others else ()
    return Needs(missing_of_plan(plan, world), lambda name: is_installed(name, world), notes)


def _list_texts(folders: Sequence[str]) -> Iterator[Path]:
    for folder in folders:
        for place, below, files in os.walk(folder):
            below[:] = sorted(name for name in below if name not in _SKIPPED)
            yield from (Path(place, name) for name in sorted(files) if name.endswith(_TEXTS) or name == "package.xml")


def _with_folders(folders: Sequence[str], environment: Mapping[str, str]) -> dict[str, str]:
    paths = [str(Path(folder).resolve()) for folder in folders]
    return {**environment, "ROS_PACKAGE_PATH": os.pathsep.join([*paths, environment.get("ROS_PACKAGE_PATH", "")])}


def _dependencies(text: str) -> tuple[str, ...]:
    try:
        return read_dependencies(text)
    except ValueError:
        return ()


def _read(path: Path) -> str:
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            return file.read(_MAX_TEXT)
    except OSError:
        return ""
