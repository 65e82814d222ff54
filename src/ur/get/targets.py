"""Missing packages of what a command line names: launch files, packages, folders."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.get.hints import LISTS, TEXTS, read_hints
from ur.get.index import read_dependencies
from ur.get.missing import is_installed, missing_of_names, missing_of_plan, named_packages
from ur.get.model import PACKAGE_NAME, Missing, Repository
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
    """Missing packages, a test for packages that are there, and notes on what could not be read.

    `hints` are the repositories that the files of folders name, and `names` the packages that are there.
    """

    missing: tuple[Missing, ...]
    is_there: Callable[[str], bool]
    notes: tuple[str, ...] = ()
    hints: tuple[Repository, ...] = ()
    names: tuple[str, ...] = ()


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
    hints: tuple[Repository, ...] = ()
    for word in words:
        if "/" in word or word in (".", ".."):
            needs = folder_needs([word], environment)
            world, notes = SystemWorld(_with_folders([word], environment)), (*notes, *needs.notes)
            hints += needs.hints
            found.update((each.package, each) for each in needs.missing)
        elif not PACKAGE_NAME.fullmatch(word):
            message = f"{word!r} is neither a launch file nor the name of a package"
            raise UserError(error(message, rule="unknown-package", help="ur get --help"))
        elif is_installed(word, world):
            text = _read(Path(world.find_package(word)) / "package.xml")
            found.update((each.package, each) for each in missing_of_names(_dependencies(text), world))
        else:
            found[word] = Missing(word)
    names = tuple(world.package_names())
    return Needs(tuple(found.values()), lambda name: is_installed(name, world), notes, hints, names)


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
    names: dict[str, str] = {}
    hints: list[Repository] = []
    for count, (folder, path) in enumerate(_list_texts(folders)):
        if count % 50 == 0:
            progress(f"{count} files read")
        text = _read(path)
        found: Iterable[str] = ()
        if path.name == "package.xml":
            found = _dependencies(text) if manifests else ()
        elif path.name.endswith(_TEXTS):
            found = named_packages(text)
        else:
            hints += read_hints(path.name, text)
        for name in found:
            names.setdefault(name, str(path.relative_to(folder)))
    missing = missing_of_names(names, world)
    here = tuple(world.package_names())
    return Needs(missing, lambda name: is_installed(name, world), hints=tuple(hints), names=here)


def _file_needs(words: Sequence[str], world: SystemWorld) -> Needs:
    request = make_request(words, world)
    plan = load_plan(request.files.paths, [str(each) for each in request.arguments], world, parsed=request.files.parsed)
    others = [
        each for each in plan.diagnostics if each.severity is Severity.ERROR and each.rule not in
        ("unknown-package", "missing-executable")
    ]  # fmt: skip
    notes = (f"not everything was read: {others[0].message}",) if others else ()
    missing = missing_of_plan(plan, world)
    names = tuple(world.package_names()) if missing else ()
    return Needs(missing, lambda name: is_installed(name, world), notes, names=names)


def _list_texts(folders: Sequence[str]) -> Iterator[tuple[str, Path]]:
    for folder in folders:
        for place, below, files in os.walk(folder):
            below[:] = sorted(name for name in below if name not in _SKIPPED)
            for name in sorted(files):
                if name.endswith(_TEXTS) or name == "package.xml" or LISTS.fullmatch(name) or TEXTS.fullmatch(name):
                    yield folder, Path(place, name)


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
